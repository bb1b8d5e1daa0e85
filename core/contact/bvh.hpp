// Bounding volume hierarchy over boxes: built once, refitted between iterations, rebuilt by a deterministic
// rule; tree against tree gives the overlapping pairs. Knows boxes and no physics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/aabb.hpp"

namespace bb {

/// A pair of primitives by index.
struct IndexPair {
  int first, second;
  friend auto operator<=>(const IndexPair&, const IndexPair&) = default;
};

/// Balanced binary tree, median split along the widest axis of the box centres.
class Bvh {
 public:
  struct Node {
    Aabb box;
    int begin, end;  // its primitives: order()[begin .. end)
    int right;       // second child (the first one is the next node), -1 for a leaf
    bool any_free;
  };

  /// Takes the boxes of all n primitives; `free` says which of them a solver can move. The first call, and a
  /// call with another n, builds: O(n log n). Later calls refit, O(n), and rebuild when the boxes of the
  /// inner nodes, relative to those of the leaves, have grown by more than a half since the last build.
  void update(std::span<const Aabb> boxes, std::span<const std::uint8_t> free);

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<int>& order() const { return order_; }
  const Aabb& box(int primitive) const { return boxes_[static_cast<std::size_t>(primitive)]; }
  /// box(order()[i]), from a column in the order of the leaves.
  const Aabb& box_in_order(int i) const { return ordered_boxes_[static_cast<std::size_t>(i)]; }
  bool is_free(int primitive) const { return free_[static_cast<std::size_t>(primitive)] != 0; }
  int builds() const { return builds_; }
  /// Nodes of at most `size` primitives that together hold all: the units of parallel work.
  void cut(int size, std::vector<int>& out) const;

 private:
  void build();
  int split(int begin, int end);
  void refit();
  double looseness() const;

  std::vector<Aabb> boxes_, ordered_boxes_;
  std::vector<std::uint8_t> free_;
  std::vector<int> order_;
  std::vector<Node> nodes_;  // preorder
  double built_looseness_ = 0;
  int builds_ = 0;
};

namespace detail {

/// Overlaps of the subtree `start` of a with all of b, in no particular order. Same tree: each pair once.
template <class Keep>
void subtree_pairs(const Bvh& a, int start, const Bvh& b, const Keep& keep, std::vector<IndexPair>& stack,
                   std::vector<IndexPair>& out) {
  const bool self = &a == &b;
  stack.clear();
  stack.push_back({start, 0});
  while (!stack.empty()) {
    const auto [ia, ib] = stack.back();
    stack.pop_back();
    const Bvh::Node& na = a.nodes()[static_cast<std::size_t>(ia)];
    const Bvh::Node& nb = b.nodes()[static_cast<std::size_t>(ib)];
    if (self && nb.end <= na.begin + 1) continue;
    if (!(na.any_free || nb.any_free) || !na.box.overlaps(nb.box)) continue;
    const bool split_a = na.right >= 0 && (nb.right < 0 || na.end - na.begin >= nb.end - nb.begin);
    if (split_a) {
      stack.push_back({ia + 1, ib});
      stack.push_back({na.right, ib});
    } else if (nb.right >= 0) {
      stack.push_back({ia, ib + 1});
      stack.push_back({ia, nb.right});
    } else {
      for (int i = na.begin; i < na.end; ++i) {
        for (int j = self && nb.begin <= i ? i + 1 : nb.begin; j < nb.end; ++j) {
          IndexPair pair{a.order()[static_cast<std::size_t>(i)], b.order()[static_cast<std::size_t>(j)]};
          if (!a.box_in_order(i).overlaps(b.box_in_order(j))) continue;
          if (!(a.is_free(pair.first) || b.is_free(pair.second))) continue;
          if (self && pair.first > pair.second) std::swap(pair.first, pair.second);
          if (keep(pair)) out.push_back(pair);
        }
      }
    }
  }
}

/// Runs task(k, stack, out) for k in [0, n), in parallel, and leaves all results in `pairs`, sorted.
class PairCollector {
 public:
  using Task = void (*)(const void* self, std::size_t k, std::vector<IndexPair>& stack,
                        std::vector<IndexPair>& out);
  void run(std::size_t n, Task task, const void* self, std::vector<IndexPair>& pairs);

 private:
  std::vector<std::vector<IndexPair>> parts_, stacks_;  // kept between calls
};

}  // namespace detail

/// Finds overlapping pairs; keeps its buffers between calls. Not thread-safe, parallel inside.
class PairFinder {
 public:
  /// All pairs (primitive of a, primitive of b) whose boxes overlap, of which at least one is free, and for
  /// which keep(pair) holds. Sorted, so independent of threads and of the shape of the trees. When a and b
  /// are the same object each unordered pair comes once, first < second.
  template <class Keep>
  void find(const Bvh& a, const Bvh& b, const Keep& keep, std::vector<IndexPair>& pairs) {
    pairs.clear();
    if (a.nodes().empty() || b.nodes().empty()) return;
    constexpr int task_size = 256;  // primitives; small enough to balance, large enough to amortise a task
    a.cut(task_size, starts_);
    const auto task = [&](std::size_t k, std::vector<IndexPair>& stack, std::vector<IndexPair>& out) {
      detail::subtree_pairs(a, starts_[k], b, keep, stack, out);
    };
    using TaskType = decltype(task);
    collector_.run(
        starts_.size(),
        [](const void* self, std::size_t k, std::vector<IndexPair>& stack, std::vector<IndexPair>& out) {
          (*static_cast<const TaskType*>(self))(k, stack, out);
        },
        &task, pairs);
  }

 private:
  detail::PairCollector collector_;
  std::vector<int> starts_;
};

}  // namespace bb
