// A bounding volume hierarchy over primitives in the order of a space-filling curve, and the walk through it. Four
// children a node and no links: node i of a level holds nodes 4 i to 4 i + 3 of the level below, and level 0 is the
// primitives. So there is nothing to build but boxes, level by level, no thread waits for what another one writes, and
// a walk needs no stack and can go on from any place.
// Source: Lauterbach et al. 2009 and Karras 2012 for the order by Morton codes; the implicit tree is that of
// core/contact/bvh.hpp.
#pragma once

#include <cstdint>

#include "core/contact/box_gap.hpp"
#include "core/contact/executor/sibling_boxes.hpp"
#include "core/exec/kernel.hpp"

namespace bb::exec {

constexpr int max_tree_levels = 17;  // 2^32 primitives

/// A box, whether something in it is free, and for a leaf its primitive and what the box was grown by on every side.
struct TreeNode {
  float lo[3], hi[3];
  float reach;        // m; 0 above the leaves
  std::uint32_t tag;  // 2 primitive + 1 where something is free

  BB_HD int primitive() const { return static_cast<int>(tag >> 1); }
  BB_HD std::uint32_t free() const { return tag & 1; }
};

/// Four siblings side by side, number by number: 128 bytes, which a walk reads at once and tests without a branch.
struct TreeGroup {
  OfSiblings<float> lo[3], hi[3], reach;
  OfSiblings<std::uint32_t> tag;

  BB_HD TreeNode node(int k) const {
    return {{lo[0][k], lo[1][k], lo[2][k]}, {hi[0][k], hi[1][k], hi[2][k]}, reach[k], tag[k]};
  }
  BB_HD void put(int k, const TreeNode& node) {
    for (int c = 0; c < 3; ++c) lo[c].set(k, node.lo[c]), hi[c].set(k, node.hi[c]);
    reach.set(k, node.reach);
    tag.set(k, node.tag);
  }
  /// Bit k where sibling k may meet a box: one of the two is free, and they overlap. Clear where a coordinate is NaN.
  BB_HD unsigned meeting(const TreeNode& a) const { return overlapping(lo, hi, tag, a.lo, a.hi, a.tag); }
  /// Whether leaf k is proven farther from the leaf a than their reaches.
  BB_HD bool apart(const TreeNode& a, int k) const {
    const TreeNode b = node(k);
    return apart_by_boxes<float>(a.lo, a.hi, b.lo, b.hi, a.reach + b.reach);
  }
};

struct TreeView {
  const TreeGroup* group;
  Index begin[max_tree_levels];  // of each level in `group`
  Index n;                       // leaves
  int top;                       // the level with one node; -1 in an empty tree

  BB_HD Index size(int level) const { return (n + (Index{1} << 2 * level) - 1) >> 2 * level; }
  /// Node i of a level.
  BB_HD TreeNode node(int level, Index i) const {
    return group[begin[level] + i / tree_width].node(static_cast<int>(i % tree_width));
  }
  BB_HD TreeNode leaf(Index place) const { return node(0, place); }
};

/// The siblings of a group that a walk visits: those that the querying leaf may meet, from place `from` on.
BB_HD inline unsigned to_visit(const TreeView& tree, int level, Index group, const TreeNode& asking,
                               Index from) {
  const TreeGroup& of = tree.group[tree.begin[level] + group];
  unsigned out = of.meeting(asking);
  const Index before = (from >> 2 * level) - tree_width * group;  // siblings that end before `from`
  if (before > 0) out &= ~0u << (before < tree_width ? before : Index{tree_width});
  // A box of all numbers meets those of siblings that are not there, too.
  const Index there = tree.size(level) - tree_width * group;
  if (there < tree_width) out &= (1u << there) - 1;
  if (level > 0) return out;
  for (int k = 0; k < tree_width; ++k) {
    if ((out >> k & 1) != 0 && of.apart(asking, k)) out &= ~(1u << k);
  }
  return out;
}
BB_HD inline int lowest_bit(unsigned four) {
  return (four & 3) != 0 ? ((four & 1) != 0 ? 0 : 1) : ((four & 4) != 0 ? 2 : 3);
}

/// Calls f(primitive) for the leaves from place `from` on that may come within reach of the leaf `asking`, in the order of
/// their places, until it returns false. @return the place behind the last one that it was called for; tree.n where no
/// leaf is left. What is still to be visited is four bits a level, so that no stack is kept and every group is read once.
template <class F>
BB_HD Index for_each_overlap(const TreeView& tree, const TreeNode& asking, Index from, const F& f) {
  if (from >= tree.n) return tree.n;
  const int last = tree.top > 0 ? tree.top - 1 : 0;
  int level = last;
  Index group = 0;
  std::uint64_t later = 0;  // of the levels above
  unsigned now = to_visit(tree, level, group, asking, from);
  for (;;) {
    while (now == 0) {
      if (level == last) return tree.n;
      ++level;
      group /= tree_width;
      now = static_cast<unsigned>(later & 15);
      later >>= 4;
    }
    const int k = lowest_bit(now);
    const Index node = tree_width * group + k;
    now &= now - 1;
    if (level > 0) {
      later = later << 4 | now;
      --level;
      group = node;
      now = to_visit(tree, level, group, asking, from);
    } else if (!f(tree.group[group].tag[k] >> 1)) {
      return node + 1;
    }
  }
}

}  // namespace bb::exec
