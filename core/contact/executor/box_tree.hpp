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
        order_(executor, "tree order"),
        group_{{executor, "tree of points"},
               {executor, "tree of edges"},
               {executor, "tree of triangles"},
               {executor, "tree of lone edges"}} {}
  /// of.begin is set here. codes: memory for size() of them, until fit() returns.
  void fit(TreeSources of, Key* codes);
  static Index size(const TreeSources& of) { return of.points.n + of.edges.n + of.triangles.n + of.lone.n; }
  void free() {
    order_.free();
    for (auto& groups : group_) groups.free();
  }
  /// Of the last fit.
  TreeView view(int tree) const;

 private:
  Executor& executor_;
  Buffer<std::uint32_t> order_;
  Buffer<TreeGroup> group_[n_trees];
  TreePlaces place_[n_trees]{};
};

}  // namespace bb::exec
