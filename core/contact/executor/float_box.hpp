// Boxes of primitives on a motion, in float and rounded outward: the arithmetic of core/contact/tree_box.hpp and of
// BroadPhase, number by number, for kernels.
#pragma once

#include <limits>

#include "core/contact/executor/executor_surface.hpp"
#include "core/contact/float_rounding.hpp"
#include "core/contact/folded_axis.hpp"

namespace bb::exec {

/// Closed box, m.
struct FloatBox {
  float lo[3], hi[3];
};

BB_HD inline FloatBox empty_box() {
  constexpr float inf = std::numeric_limits<float>::infinity();
  return {{inf, inf, inf}, {-inf, -inf, -inf}};
}

/// Coordinate c takes in [lo, hi].
BB_HD inline void widen(FloatBox& box, int c, float lo, float hi) {
  box.lo[c] = box.lo[c] < lo ? box.lo[c] : lo;
  box.hi[c] = box.hi[c] > hi ? box.hi[c] : hi;
}

/// Adds the coordinate of a point and all that is within `margin` (m, >= 0) of it, rounded outward.
BB_HD inline void add_coordinate(FloatBox& box, int c, double x, double margin) {
  constexpr float largest = std::numeric_limits<float>::max();  // beyond it, only one side is infinite
  const float lo = float_below(x - margin), hi = float_above(x + margin);
  widen(box, c, largest < lo ? largest : lo, hi < -largest ? -largest : hi);
}

/// Grows by `margin` (m, >= 0) on every side, rounded outward.
BB_HD inline void inflate(FloatBox& box, double margin) {
  const float grow = float_above(margin);
  for (int c = 0; c < 3; ++c) {
    const float lo = box.lo[c] - grow, hi = box.hi[c] + grow;
    box.lo[c] = lo - ((lo < 0 ? -lo : lo) * 0x1p-23f + 0x1p-126f);
    box.hi[c] = hi + ((hi < 0 ? -hi : hi) * 0x1p-23f + 0x1p-126f);
  }
}

/// Where positions are put before boxes are made, and what is subtracted at the end of the motion before that.
struct MotionFrame {
  FoldedFrame folded;
  double moved[3];  // m
};

/// A motion as kernels read it. Every state on it is (1 - t) x0 + t x1.
struct MotionView {
  const double *x0, *x1;  // [3 n_vertices] m; equal: a state
  const MotionFrame* frame;
};

/// The share of primitive i of the contact distance, m.
template <int N>
BB_HD double contact_reach(const PrimitiveView<N>& of, Index i) {
  return of.d_hat[i] / 2 + of.offset[i];
}

/// The box of primitive i with its share of the contact distance.
template <int N>
BB_HD FloatBox primitive_box(const PrimitiveView<N>& of, Index i, const MotionView& motion) {
  const MotionFrame& frame = *motion.frame;
  FloatBox box = empty_box();
  for (int k = 0; k < N; ++k) {
    const Index v = of.vertex[N * i + k];
    FloatBox vertex = empty_box();
    for (int c = 0; c < 3; ++c) {
      const FoldedAxis& place = frame.folded.axis[c];
      const double x0 = motion.x0[3 * v + c], x1 = motion.x1[3 * v + c], moved = frame.moved[c];
      const double margin = place_rounding(x0, x1, moved);
      add_coordinate(vertex, c, place(x0), margin);
      if (motion.x0 != motion.x1) add_coordinate(vertex, c, place(x1 - moved), margin);
      widen(box, c, vertex.lo[c], vertex.hi[c]);
    }
  }
  inflate(box, contact_reach(of, i));
  return box;
}

}  // namespace bb::exec
