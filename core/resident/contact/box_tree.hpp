// The tree of one kind of primitive of a surface, fitted anew to each motion.
#pragma once

#include "core/resident/contact/tree_kernels.hpp"

namespace bb::resident {

/// What building needs beside the trees; shared by all of them.
struct TreeScratch {
  explicit TreeScratch(exec::Executor& executor)
      : key(executor, "tree Morton codes"), order(executor, "tree order") {}
  exec::Buffer<Key> key;
  exec::Buffer<std::uint32_t> order;
};

/// Built by a sort at every fit: that is 12 B a primitive read and written a few times, less than a search reads, and
/// the order is then that of the motion itself, never one of an earlier state. 43 B a primitive.
template <int N>
class BoxTree {
 public:
  BoxTree(exec::Executor& executor, const std::string& name) : executor_(&executor), node_(executor, name) {}
  void fit(const PrimitiveView<N>& of, const MotionView& motion, TreeScratch& scratch);
  void free() { node_.free(); }
  /// Of the last fit.
  TreeView view() const {
    TreeView out = view_;
    out.node = node_.data();
    return out;
  }

 private:
  void sort_codes(const PrimitiveView<N>& of, const MotionView& motion, TreeScratch& scratch);

  exec::Executor* executor_;
  exec::Buffer<TreeNode> node_;
  TreeView view_{nullptr, {}, -1};
};

}  // namespace bb::resident
