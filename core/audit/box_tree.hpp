// Broad phase: a tree of axis-aligned boxes over primitives in Morton order. Box ends are input
// doubles, so that nothing is rounded and no inflation is needed: the hull of a linear motion lies in
// the box of its ends.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "core/math/types.hpp"

namespace bb::audit {

struct Box {
  Vec3d lo = Vec3d::Constant(std::numeric_limits<double>::infinity());
  Vec3d hi = -lo;
  void add(const Vec3d& p) { lo = lo.cwiseMin(p), hi = hi.cwiseMax(p); }
  void add(const Box& b) { lo = lo.cwiseMin(b.lo), hi = hi.cwiseMax(b.hi); }
  /// Closed boxes: sharing a face counts. An empty box meets nothing.
  bool meets(const Box& b) const {
    return (lo.array() <= b.hi.array()).all() && (b.lo.array() <= hi.array()).all();
  }
};

/// Complete binary tree, leaves of a few primitives. Build O(n log n), deterministic for any thread count.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);

  /// Calls found(i) once for every box i that meets `box`, in an order fixed by the tree. Allocates nothing.
  template <class F>
  void query(const Box& box, F&& found) const {
    int stack[64];
    int top = 0;
    stack[top++] = 1;
    while (top > 0) {
      const int node = stack[--top];
      if (!nodes_[static_cast<std::size_t>(node)].meets(box)) continue;
      if (node >= n_leaves_) {
        visit_leaf(node - n_leaves_, box, found);
      } else {
        stack[top++] = 2 * node + 1;
        stack[top++] = 2 * node;
      }
    }
  }

 private:
  static constexpr int leaf_size = 4;

  template <class F>
  void visit_leaf(int leaf, const Box& box, F&& found) const {
    const std::size_t begin = static_cast<std::size_t>(leaf) * leaf_size;
    for (std::size_t i = begin; i < std::min(begin + leaf_size, order_.size()); ++i) {
      if (boxes_[i].meets(box)) found(order_[i]);
    }
  }

  std::vector<Box> boxes_;  // in Morton order
  std::vector<int> order_;  // Morton order -> primitive
  std::vector<Box> nodes_;  // 1 is the root, 2i and 2i + 1 the children of i
  int n_leaves_ = 1;        // a power of two; leaves start at this node
};

}  // namespace bb::audit
