// Kernels that fit a tree to a motion: frame, bounds, Morton codes, leaves, levels.
#pragma once

#include <cmath>

#include "core/resident/contact/float_box.hpp"
#include "core/resident/contact/tree_view.hpp"

namespace bb::resident {

/// Bits that compare as x does; no numbers are first and last.
BB_HD inline Key sortable_bits(double x) {
  const Key bits = exec::ordered_bits(x), sign = Key{1} << 63;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
BB_HD inline double from_sortable_bits(Key bits) {
  const Key sign = Key{1} << 63;
  return exec::from_ordered_bits((bits & sign) != 0 ? bits & ~sign : ~bits);
}

/// key[i]: coordinate c of the displacement of surface point i.
struct DisplacementKeys {
  const int* vertex;
  const double *x0, *x1;
  int c;
  Key* key;
  BB_HD void operator()(Index i) const {
    const Index at = 3 * static_cast<Index>(vertex[i]) + c;
    key[i] = sortable_bits(x1[at] - x0[at]);
  }
};

/// The frame at the first point: x0 there, at both ends.
struct StartFrame {
  const int* vertex;
  const double* x0;
  MotionFrame* frame;
  BB_HD void operator()(Index) const {
    const double* const origin = x0 + 3 * static_cast<Index>(vertex[0]);
    bool finite = true;
    for (int c = 0; c < 3; ++c) finite = finite && origin[c] - origin[c] == 0;
    for (int c = 0; c < 3; ++c) frame->start[c] = frame->end[c] = finite ? origin[c] : 0;
  }
};

/// Moves the end of the frame along axis c by the median of n sorted displacements; not at all where one is no number.
struct MoveFrame {
  const Key* sorted;
  Index n;
  int c;
  MotionFrame* frame;
  BB_HD void operator()(Index) const {
    const double first = from_sortable_bits(sorted[0]), last = from_sortable_bits(sorted[n - 1]);
    if (first - first == 0 && last - last == 0) frame->end[c] += from_sortable_bits(sorted[n / 2]);
  }
};

/// What a box that knows the ulps of what it holds still lacks: positions are larger by the frame.
struct RoundFrame {
  MotionFrame* frame;
  BB_HD void operator()(Index) const {
    double start = 0, end = 0;
    for (int c = 0; c < 3; ++c) {
      const double s = std::abs(frame->start[c]), e = std::abs(frame->end[c]);
      start = s > start ? s : start;
      end = e > end ? e : end;
    }
    frame->rounding = 4 * std::numeric_limits<double>::epsilon() * (start + end);
  }
};

/// Twice the centre of a box along axis c, m.
BB_HD inline double twice_centre(const FloatBox& box, int c) {
  return static_cast<double>(box.lo[c]) + static_cast<double>(box.hi[c]);
}

/// least[c] and most[c] (complemented), as sortable bits: of twice the centres of all boxes that
/// have finite ones.
template <int N>
struct CentreBounds {
  PrimitiveView<N> of;
  MotionView motion;
  Key *least, *most;  // [3] all ones before

  struct Shared {
    Key least[3][exec::block_threads], most[3][exec::block_threads];
  };
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const CentreBounds k = *this;
    Shared* const s = &shared;
    block.threads([=](int t) {
      for (int c = 0; c < 3; ++c) s->least[c][t] = s->most[c][t] = ~Key{0};
      const Index i = b * exec::block_threads + t;
      if (i >= k.of.n) return;
      const FloatBox box = primitive_box(k.of, i, k.motion);
      for (int c = 0; c < 3; ++c) {
        const double x = twice_centre(box, c);
        if (!(x - x == 0)) continue;
        s->least[c][t] = sortable_bits(x);
        s->most[c][t] = ~sortable_bits(x);
      }
    });
    for (int half = exec::block_threads / 2; half > 0; half /= 2) {
      block.threads([=](int t) {
        if (t >= half) return;
        for (int c = 0; c < 3; ++c) {
          Key &low = s->least[c][t], &high = s->most[c][t];
          low = s->least[c][t + half] < low ? s->least[c][t + half] : low;
          high = s->most[c][t + half] < high ? s->most[c][t + half] : high;
        }
      });
    }
    block.threads([=](int t) {
      if (t >= 3) return;
      exec::atomic_min(&k.least[t], s->least[t][0]);
      exec::atomic_min(&k.most[t], s->most[t][0]);
    });
  }
};

/// The lowest 21 bits of x, two zeros between each two.
BB_HD inline Key spread(Key x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

constexpr int morton_bits = 63;

/// key[i]: Morton code of the centre of box i in cubic cells; value[i] = i. Which order equal codes come in is the
/// index's, for the sort is stable.
template <int N>
struct MortonKeys {
  PrimitiveView<N> of;
  MotionView motion;
  const Key *least, *most;
  Key* key;
  std::uint32_t* value;
  BB_HD void operator()(Index i) const {
    constexpr double cells = 0x1p21;
    double lo[3], width = 0;
    for (int c = 0; c < 3; ++c) {
      lo[c] = from_sortable_bits(least[c]);
      const double w = from_sortable_bits(~most[c]) - lo[c];
      width = w > width ? w : width;
    }
    const FloatBox box = primitive_box(of, i, motion);
    Key code = 0;
    for (int c = 0; c < 3; ++c) {
      const double place = (twice_centre(box, c) - lo[c]) * (cells / width);
      const Key cell = place > 0 ? (place < cells ? static_cast<Key>(place) : Key{0x1fffff}) : Key{0};
      code |= spread(cell) << c;
    }
    key[i] = code;
    value[i] = static_cast<std::uint32_t>(i);
  }
};

/// Leaves in the order of their codes.
template <int N>
struct TreeLeaves {
  PrimitiveView<N> of;
  MotionView motion;
  const std::uint32_t* primitive;
  TreeNode* node;
  BB_HD void operator()(Index place) const {
    const Index i = primitive[place];
    const FloatBox box = primitive_box(of, i, motion);
    TreeNode out;
    for (int c = 0; c < 3; ++c) out.lo[c] = box.lo[c], out.hi[c] = box.hi[c];
    out.primitive = static_cast<int>(i);
    out.free = of.free[i] != 0 ? 1 : 0;
    node[place] = out;
  }
};

/// Node i of a level from the n of the level below it. A number that is none is never less and never more.
struct TreeLevel {
  const TreeNode* below;
  Index n;
  TreeNode* node;
  BB_HD void operator()(Index i) const {
    FloatBox box = empty_box();
    TreeNode out;
    out.primitive = -1;
    out.free = 0;
    const Index begin = tree_width * i, end = begin + tree_width < n ? begin + tree_width : n;
    for (Index child = begin; child < end; ++child) {
      const TreeNode at = below[child];
      for (int c = 0; c < 3; ++c) {
        box.lo[c] = at.lo[c] < box.lo[c] ? at.lo[c] : box.lo[c];
        box.hi[c] = at.hi[c] > box.hi[c] ? at.hi[c] : box.hi[c];
      }
      out.free |= at.free;
    }
    for (int c = 0; c < 3; ++c) out.lo[c] = box.lo[c], out.hi[c] = box.hi[c];
    node[i] = out;
  }
};

}  // namespace bb::resident
