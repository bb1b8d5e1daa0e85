// The trees of the primitives of a surface, fitted anew to each motion: all of them by the same launches.
#pragma once

#include "core/contact/executor/tree_kernels.hpp"

namespace bb::exec {

/// Built by a sort at every fit: that is 12 B a primitive read and written a few times, less than a search reads, and
/// the order is then that of the motion itself, never one of an earlier state. 43 B a primitive.
class BoxTrees {
 public:
  BoxTrees(Executor& executor)
      : executor_(executor),
        key_(executor, "tree Morton codes"),
        order_(executor, "tree order"),
        node_{{executor, "tree of points"},
              {executor, "tree of edges"},
              {executor, "tree of triangles"},
              {executor, "tree of lone edges"}} {}
  /// of.begin is set here.
  void fit(TreeSources of);
  void free() {
    key_.free(), order_.free();
    for (auto& node : node_) node.free();
  }
  /// Room for keys, until fit().
  Key* keys(Index n) {
    if (key_.size() < n) key_.resize(n);
    return key_.data();
  }
  /// Of the last fit.
  TreeView view(int tree) const;

 private:
  Executor& executor_;
  Buffer<Key> key_;
  Buffer<std::uint32_t> order_;
  Buffer<TreeNode> node_[n_trees];
  TreePlaces place_[n_trees]{};
};

}  // namespace bb::exec
