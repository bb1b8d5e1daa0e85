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

/// key[k]: coordinate c of sampled point k at the start; those that are no numbers come last.
struct SampleKeys {
  const int* vertex;
  Index n;
  const double* x0;
  int c;
  Key* key;
  BB_HD void operator()(Index k) const {
    const double x = x0[3 * static_cast<Index>(vertex[sampled(static_cast<int>(k), n)]) + c];
    key[k] = x - x == 0 ? sortable_bits(x) : ~Key{0};
  }
};

/// The frame of n sorted coordinates an axis, most_sampled apart, without any motion.
struct FoldFrame {
  const Key* sorted;
  int n;
  double size;  // Surface::element_size
  MotionFrame* frame;
  BB_HD void operator()(Index) const {
    const Key* const all = sorted;
    const int n_all = n;
    const auto coordinate = [all](int c, int i) { return from_sortable_bits(all[most_sampled * c + i]); };
    const auto count = [all, n_all](int c) {
      int n_finite = n_all;
      while (n_finite > 0 && all[most_sampled * c + n_finite - 1] == ~Key{0}) --n_finite;
      return n_finite;
    };
    frame->folded = folded_frame(coordinate, count, size);
    for (int c = 0; c < 3; ++c) frame->moved[c] = 0;
  }
};

/// What is shared of the motion along axis c: the median of n sorted displacements; nothing where one is no number.
struct MoveFrame {
  const Key* sorted;
  Index n;
  int c;
  MotionFrame* frame;
  BB_HD void operator()(Index) const {
    const double first = from_sortable_bits(sorted[0]), last = from_sortable_bits(sorted[n - 1]);
    if (first - first == 0 && last - last == 0) frame->moved[c] = from_sortable_bits(sorted[n / 2]);
  }
};

/// Twice the centre of a box along axis c, m.
BB_HD inline double twice_centre(const FloatBox& box, int c) {
  return static_cast<double>(box.lo[c]) + static_cast<double>(box.hi[c]);
}

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

/// key[i]: Morton code of the centre of box i in the cubic cells of the frame's grid, those outside in its outmost ones;
/// value[i] = i. Which order equal codes come in is the index's, for the sort is stable.
template <int N>
struct MortonKeys {
  PrimitiveView<N> of;
  MotionView motion;
  Key* key;
  std::uint32_t* value;
  BB_HD void operator()(Index i) const {
    constexpr double cells = 0x1p21;
    const FoldedFrame& frame = motion.frame->folded;
    const FloatBox box = primitive_box(of, i, motion);
    Key code = 0;
    for (int c = 0; c < 3; ++c) {
      const double place = (twice_centre(box, c) / 2 - frame.grid_lo[c]) * (cells / frame.grid_width);
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
    out.reach = float_above(contact_reach(of, i));
    out.tag = 2 * static_cast<std::uint32_t>(i) + (of.free[i] != 0 ? 1 : 0);
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
    out.reach = 0;
    out.tag = 0;
    const Index begin = tree_width * i, end = begin + tree_width < n ? begin + tree_width : n;
    for (Index child = begin; child < end; ++child) {
      const TreeNode at = below[child];
      for (int c = 0; c < 3; ++c) {
        box.lo[c] = at.lo[c] < box.lo[c] ? at.lo[c] : box.lo[c];
        box.hi[c] = at.hi[c] > box.hi[c] ? at.hi[c] : box.hi[c];
      }
      out.tag |= at.free();
    }
    for (int c = 0; c < 3; ++c) out.lo[c] = box.lo[c], out.hi[c] = box.hi[c];
    node[i] = out;
  }
};

}  // namespace bb::resident
