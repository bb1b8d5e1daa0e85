#include "core/contact/executor/box_tree.hpp"

#include <algorithm>

namespace bb::exec {

namespace {

/// The levels of a tree over n leaves.
TreePlaces levels_of(Index n) {
  TreePlaces out{nullptr, {}, -1};
  if (n == 0) return out;
  for (Index size = n;; size = (size + tree_width - 1) / tree_width) {
    ++out.top;
    out.begin[out.top + 1] = out.begin[out.top] + size;
    if (size == 1) return out;
  }
}

}  // namespace

void BoxTrees::fit(TreeSources of) {
  const Index size[n_trees] = {of.points.n, of.edges.n, of.triangles.n, of.lone.n};
  TreeLevels levels{};
  int top = -1;
  of.begin[0] = 0;
  for (int k = 0; k < n_trees; ++k) {
    of.begin[k + 1] = of.begin[k] + size[k];
    place_[k] = levels_of(size[k]);
    node_[k].resize(place_[k].top < 0 ? 0 : place_[k].begin[place_[k].top + 1]);
    place_[k].node = node_[k].data();
    levels.tree[k] = place_[k];
    top = std::max(top, place_[k].top);
  }
  const Index n = of.begin[n_trees];
  Key* const key = keys(n);
  order_.resize(n);
  executor_.each(n, MortonKeys{of, key, order_.data()});
  executor_.sort(key, order_.data(), n, morton_bits + 2);
  levels.of = of;
  levels.primitive = order_.data();
  for (levels.from = 0; levels.from <= std::max(top - 1, 0) && n > 0; levels.from += TreeLevels::levels) {
    executor_.blocks(levels.n_blocks(), levels);
  }
}

TreeView BoxTrees::view(int tree) const {
  TreeView out{node_[tree].data(), {}, place_[tree].top};
  std::copy(std::begin(place_[tree].begin), std::end(place_[tree].begin), out.begin);
  return out;
}

}  // namespace bb::exec
