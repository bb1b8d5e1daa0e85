#include "core/resident/contact/box_tree.hpp"

namespace bb::resident {

namespace {

/// The levels of a tree over n leaves.
TreeView levels_of(Index n) {
  TreeView out{nullptr, {}, -1};
  if (n == 0) return out;
  for (Index size = n;; size = (size + tree_width - 1) / tree_width) {
    ++out.top;
    out.begin[out.top + 1] = out.begin[out.top] + size;
    if (size == 1) return out;
  }
}

}  // namespace

template <int N>
void BoxTree<N>::sort_codes(const PrimitiveView<N>& of, const MotionView& motion, TreeScratch& scratch) {
  scratch.key.resize(of.n);
  scratch.order.resize(of.n);
  executor_->each(of.n, MortonKeys<N>{of, motion, scratch.key.data(), scratch.order.data()});
  executor_->sort(scratch.key.data(), scratch.order.data(), of.n, morton_bits);
}

template <int N>
void BoxTree<N>::fit(const PrimitiveView<N>& of, const MotionView& motion, TreeScratch& scratch) {
  view_ = levels_of(of.n);
  if (of.n == 0) return;
  sort_codes(of, motion, scratch);
  node_.resize(view_.begin[view_.top + 1]);
  executor_->each(of.n, TreeLeaves<N>{of, motion, scratch.order.data(), node_.data()});
  for (int level = 1; level <= view_.top; ++level) {
    executor_->each(view_.size(level), TreeLevel{node_.data() + view_.begin[level - 1], view_.size(level - 1),
                                                 node_.data() + view_.begin[level]});
  }
}

template class BoxTree<1>;
template class BoxTree<2>;
template class BoxTree<3>;

}  // namespace bb::resident
