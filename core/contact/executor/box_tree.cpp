#include "core/contact/executor/box_tree.hpp"

#include <algorithm>

namespace bb::exec {

namespace {

/// The levels of a tree over n leaves, and how many groups they have.
TreePlaces levels_of(Index n, Index& groups) {
  TreePlaces out{nullptr, {}, n, -1};
  groups = 0;
  if (n == 0) return out;
  for (Index size = n;; size = (size + tree_width - 1) / tree_width) {
    out.begin[++out.top] = groups;
    groups += (size + tree_width - 1) / tree_width;
    if (size == 1) return out;
  }
}

}  // namespace

void BoxTrees::fit(TreeSources of, Key* codes) {
  const Index size[n_trees] = {of.points.n, of.edges.n, of.triangles.n, of.lone.n};
  TreeLevels levels{};
  int top = -1;
  of.begin[0] = 0;
  for (int k = 0; k < n_trees; ++k) {
    of.begin[k + 1] = of.begin[k] + size[k];
    Index groups = 0;
    place_[k] = levels_of(size[k], groups);
    group_[k].resize(groups);
    place_[k].group = group_[k].data();
    levels.tree[k] = place_[k];
    top = std::max(top, place_[k].top);
  }
  const Index n = of.begin[n_trees];
  order_.resize(n);
  executor_.each(n, MortonKeys{of, codes, order_.data()});
  executor_.sort(codes, order_.data(), n, morton_bits + 2);
  levels.of = of;
  levels.primitive = order_.data();
  for (levels.from = 0; levels.from <= std::max(top - 1, 0) && n > 0; levels.from += TreeLevels::levels) {
    executor_.blocks(levels.n_blocks(), levels);
  }
}

TreeView BoxTrees::view(int tree) const {
  TreeView out{group_[tree].data(), {}, place_[tree].n, place_[tree].top};
  std::copy(std::begin(place_[tree].begin), std::end(place_[tree].begin), out.begin);
  return out;
}

}  // namespace bb::exec
