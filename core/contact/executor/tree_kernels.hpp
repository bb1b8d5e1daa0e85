// Kernels that fit a tree to a motion: frame, bounds, Morton codes, leaves, levels.
#pragma once

#include <cmath>

#include "core/contact/executor/float_box.hpp"
#include "core/contact/executor/tree_view.hpp"

namespace bb::exec {

/// Bits that compare as x does; NaNs are first and last.
BB_HD inline Key sortable_bits(double x) {
  const Key bits = ordered_bits(x), sign = Key{1} << 63;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
BB_HD inline double from_sortable_bits(Key bits) {
  const Key sign = Key{1} << 63;
  return from_ordered_bits((bits & sign) != 0 ? bits & ~sign : ~bits);
}

/// One block: the frame of sampled points at the start, and what is shared of the motion along every axis: the median of
/// their displacements; nothing where one is NaN. An axis is a thread of a warp of its own.
struct FindFrame {
  static constexpr int width = most_sampled, warp = 32;
  static_assert(width == 128);
  struct Shared {
    Key sample[6][width];  // coordinates at the start, then displacements
    LargestGaps gaps[3];
    AxisFrame axis[3];
  };
  const int* vertex;
  Index n;
  const double *x0, *x1;  // equal: a state
  double size;            // Surface::element_size
  MotionFrame* frame;

  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index) const {
    const int n_all = n_sampled(n), n_lists = x0 == x1 ? 3 : 6;
    block.threads([&](int t) {
      for (int item = t; item < n_lists * width; item += block_threads) {
        shared.sample[item / width][item % width] = sample(item / width, item % width, n_all);
      }
    });
    sort(block, shared, n_lists);
    block.threads([&](int t) {
      const int c = t / warp;
      if (t % warp != 0 || c >= 6) return;
      if (c < 3) {
        shared.gaps[c] = largest_gaps(At{shared.sample[c]}, n_finite(shared.sample[c], n_all));
      } else {
        frame->moved[c - 3] = c < n_lists ? shared_motion(shared.sample[c], n_all) : 0;
      }
    });
    block.threads([&](int t) {
      const int c = t / warp;
      if (t % warp != 0 || c >= 3) return;
      shared.axis[c] = axis_frame(At{shared.sample[c]}, n_finite(shared.sample[c], n_all), shared.gaps[c],
                                  widest(shared.gaps, size));
    });
    block.once([&] { frame->folded = joined(shared.axis); });
  }

 private:
  struct At {
    const Key* sorted;
    BB_HD double operator()(int i) const { return from_sortable_bits(sorted[i]); }
  };
  /// A NaN, and what is not there, comes last.
  BB_HD Key sample(int list, int k, int n_all) const {
    if (k >= n_all) return ~Key{0};
    const Index at = 3 * static_cast<Index>(vertex[sampled(k, n)]) + list % 3;
    const double x = list < 3 ? x0[at] : x1[at] - x0[at];
    return x - x == 0 ? sortable_bits(x) : ~Key{0};
  }
  /// Bitonic: the same pairs whatever the numbers are. Source: Batcher 1968.
  template <class Block>
  BB_HD static void sort(Block& block, Shared& shared, int n_lists) {
    for (int run = 2; run <= width; run *= 2) {
      for (int apart = run / 2; apart > 0; apart /= 2) {
        block.threads([&](int t) {
          for (int item = t; item < n_lists * width / 2; item += block_threads) {
            Key* const of = shared.sample[item / (width / 2)];
            const int pair = item % (width / 2), low = 2 * apart * (pair / apart) + pair % apart;
            put_in_order(of[low], of[low + apart], (low & run) == 0);
          }
        });
      }
    }
  }
  BB_HD static void put_in_order(Key& a, Key& b, bool ascending) {
    const Key low = b < a ? b : a, high = b < a ? a : b;
    a = ascending ? low : high;
    b = ascending ? high : low;
  }
  BB_HD static int n_finite(const Key* sorted, int n_all) {
    while (n_all > 0 && sorted[n_all - 1] == ~Key{0}) --n_all;
    return n_all;
  }
  BB_HD static double shared_motion(const Key* sorted, int n_all) {
    return n_finite(sorted, n_all) == n_all ? median_of(At{sorted}, n_all) : 0;
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

/// The trees that a motion needs, as one range of primitives: those of points, edges, triangles, lone edges. What is not
/// needed has none.
constexpr int n_trees = 4;
struct TreeSources {
  PrimitiveView<1> points;
  PrimitiveView<2> edges;
  PrimitiveView<3> triangles;
  PrimitiveView<2> lone;
  Index begin[n_trees + 1];
  MotionView motion;

  BB_HD int tree_of(Index item) const {
    int k = 0;
    while (item >= begin[k + 1]) ++k;
    return k;
  }
  /// f(primitives) of a tree.
  template <class F>
  BB_HD auto of(int tree, const F& f) const {
    return tree == 0 ? f(points) : tree == 1 ? f(edges) : tree == 2 ? f(triangles) : f(lone);
  }
  BB_HD FloatBox box(int tree, Index i) const {
    const MotionView& m = motion;
    return of(tree, [&](const auto& primitives) { return primitive_box(primitives, i, m); });
  }
};

/// Bits of a Morton code of the centre of a box in the cubic cells of the frame's grid, less the last one; above them the
/// number of the tree.
constexpr int morton_bits = 62;

/// key[item]: the code of its primitive, those outside of the grid in its outmost cells; value: the primitive. Which order
/// equal codes come in is the index's, for the sort is stable.
struct MortonKeys {
  TreeSources of;
  Key* key;
  std::uint32_t* value;
  BB_HD void operator()(Index item) const {
    constexpr double cells = 0x1p21;
    const int tree = of.tree_of(item);
    const Index i = item - of.begin[tree];
    const FoldedFrame& frame = of.motion.frame->folded;
    const FloatBox box = of.box(tree, i);
    Key code = 0;
    for (int c = 0; c < 3; ++c) {
      const double place = (twice_centre(box, c) / 2 - frame.grid_lo[c]) * (cells / frame.grid_width);
      const Key cell = place > 0 ? (place < cells ? static_cast<Key>(place) : Key{0x1fffff}) : Key{0};
      code |= spread(cell) << c;
    }
    key[item] = static_cast<Key>(tree) << morton_bits | code >> 1;
    value[item] = static_cast<std::uint32_t>(i);
  }
};

/// The groups of a tree to be built.
struct TreePlaces {
  TreeGroup* group;
  Index begin[max_tree_levels];
  Index n;
  int top;
  BB_HD Index size(int level) const {
    return level > top ? 0 : (n + (Index{1} << 2 * level) - 1) >> 2 * level;
  }
  /// Node i of a level; with the last one its siblings that are not there, which meet nothing and widen no box.
  BB_HD void put(int level, Index i, const TreeNode& node) const {
    TreeGroup& to = group[begin[level] + i / tree_width];
    int k = static_cast<int>(i % tree_width);
    to.put(k, node);
    if (i + 1 < size(level)) return;
    const FloatBox none = empty_box();
    TreeNode absent{{none.lo[0], none.lo[1], none.lo[2]}, {none.hi[0], none.hi[1], none.hi[2]}, 0, 0};
    while (++k < tree_width) to.put(k, absent);
  }
};

/// Four levels of all trees: from the 256 nodes of a level that a block takes all that they are below of. From level 0 the
/// leaves first, in the order of their codes.
struct TreeLevels {
  static constexpr int levels = 4;  // 256 nodes are one four levels up
  struct Shared {};
  TreeSources of;
  TreePlaces tree[n_trees];
  int from;
  const std::uint32_t* primitive;  // [items]

  BB_HD Index blocks_of(int k) const { return (tree[k].size(from) + block_threads - 1) / block_threads; }
  Index n_blocks() const {
    Index out = 0;
    for (int k = 0; k < n_trees; ++k) out += blocks_of(k);
    return out;
  }
  template <class Block>
  BB_HD void operator()(Block& block, Shared&, Index b) const {
    int k = 0;
    for (; b >= blocks_of(k); ++k) b -= blocks_of(k);
    const TreePlaces& to = tree[k];
    if (from == 0) {
      block.threads([&](int t) {
        const Index place = b * block_threads + t;
        if (place < to.size(0)) to.put(0, place, leaf(k, primitive[of.begin[k] + place]));
      });
    }
    int width = block_threads;
    for (int level = from + 1; level <= from + levels; ++level) {
      width /= tree_width;
      block.threads([&](int t) {
        const Index i = b * width + t;
        if (t < width && i < to.size(level)) to.put(level, i, parent(to.group[to.begin[level - 1] + i]));
      });
    }
  }

 private:
  BB_HD TreeNode leaf(int k, Index i) const {
    const FloatBox box = of.box(k, i);
    TreeNode out;
    for (int c = 0; c < 3; ++c) out.lo[c] = box.lo[c], out.hi[c] = box.hi[c];
    out.reach = float_above(of.of(k, [&](const auto& primitives) { return contact_reach(primitives, i); }));
    const bool free = of.of(k, [&](const auto& primitives) { return primitives.free[i] != 0; });
    out.tag = 2 * static_cast<std::uint32_t>(i) + (free ? 1 : 0);
    return out;
  }
  /// The node above a group. NaN is never less and never more.
  BB_HD static TreeNode parent(const TreeGroup& children) {
    FloatBox box = empty_box();
    std::uint32_t free = 0;
    for (int child = 0; child < tree_width; ++child) {
      for (int c = 0; c < 3; ++c) {
        box.lo[c] = children.lo[c][child] < box.lo[c] ? children.lo[c][child] : box.lo[c];
        box.hi[c] = children.hi[c][child] > box.hi[c] ? children.hi[c][child] : box.hi[c];
      }
      free |= children.tag[child] & 1;
    }
    return {{box.lo[0], box.lo[1], box.lo[2]}, {box.hi[0], box.hi[1], box.hi[2]}, 0, free};
  }
};

}  // namespace bb::exec
