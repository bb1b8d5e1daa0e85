// A bounding volume hierarchy over primitives in the order of a space-filling curve, and the search in it. Four
// children a node and no links: node i of a level holds nodes 4 i to 4 i + 3 of the level below, and level 0 is the
// primitives. So there is nothing to build but boxes, level by level, no thread waits for what another one writes, and
// the search needs no stack.
// Source: Lauterbach et al. 2009 and Karras 2012 for the order by Morton codes; the implicit tree is that of
// core/contact/bvh.hpp.
#pragma once

#include <cstdint>

#include "core/contact/box_gap.hpp"
#include "core/exec/kernel.hpp"

namespace bb::exec {

/// One sector of memory: a box, whether something in it is free, and for a leaf its primitive and what the box was grown
/// by on every side.
struct alignas(16) TreeNode {
  float lo[3];
  float reach;  // m; 0 above the leaves
  float hi[3];
  std::uint32_t tag;  // 2 primitive + 1 where something is free

  BB_HD int primitive() const { return static_cast<int>(tag >> 1); }
  BB_HD std::uint32_t free() const { return tag & 1; }
};

/// One of the two free, boxes overlapping. False where a number is none.
BB_HD inline bool may_meet(const TreeNode& a, const TreeNode& b) {
  return (a.free() | b.free()) != 0 && a.lo[0] <= b.hi[0] && b.lo[0] <= a.hi[0] && a.lo[1] <= b.hi[1] &&
         b.lo[1] <= a.hi[1] && a.lo[2] <= b.hi[2] && b.lo[2] <= a.hi[2];
}

/// Whether two leaves are proven farther apart than their reaches.
BB_HD inline bool apart(const TreeNode& a, const TreeNode& b) {
  return apart_by_boxes<float>(a.lo, a.hi, b.lo, b.hi, a.reach + b.reach);
}

constexpr int tree_width = 4, max_tree_levels = 17;  // 2^32 primitives

struct TreeView {
  const TreeNode* node;
  Index begin[max_tree_levels + 1];  // of each level in `node`; begin[l + 1] - begin[l] nodes
  int top;                           // the level with one node; -1 in an empty tree
  BB_HD Index size(int level) const { return begin[level + 1] - begin[level]; }
};

/// Calls f(leaf) for the leaves from place `from` on that may come within reach of the leaf `asking`, in the order of
/// their places.
template <class F>
BB_HD void for_each_overlap(const TreeView& tree, const TreeNode& asking, Index from, const F& f) {
  if (tree.top < 0) return;
  int level = 0;
  Index at = from;
  // what comes next is as high in the tree as it can be: a node that begins where the last one ended
  const auto climb = [&] {
    for (; level < tree.top && at % tree_width == 0; ++level) at /= tree_width;
  };
  climb();
  while (at < tree.size(level)) {
    const TreeNode node = tree.node[tree.begin[level] + at];
    if (!may_meet(asking, node)) {
      ++at;
      climb();
    } else if (level > 0) {
      --level;
      at *= tree_width;
    } else {
      if (!apart(asking, node)) f(node);
      ++at;
      climb();
    }
  }
}

}  // namespace bb::exec
