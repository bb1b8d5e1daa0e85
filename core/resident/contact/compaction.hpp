// From counts of items to their places in a column without holes: count, then fill.
#pragma once

#include <string>

#include "core/exec/buffer.hpp"
#include "core/resident/contact/compaction_kernels.hpp"

namespace bb::resident {

/// From counts [n] to places [n + 1], whose last is the sum. For counts of any size; 8 B an item.
inline void scan_counts(exec::Executor& executor, Index* count, Index n) {
  executor.fill_bytes(count + n, 0, sizeof(Index));
  executor.exclusive_scan(count, n + 1);
}

/// 3 B an item; keeps its buffers.
class Compaction {
 public:
  Compaction(exec::Executor& executor, const std::string& name)
      : executor_(&executor),
        count_(executor, name + " counts"),
        rank_(executor, name + " ranks"),
        block_(executor, name + " places") {}
  /// Room for the counts of n items; a kernel fills them, at most 255 each.
  std::uint8_t* counts(Index n) {
    count_.fit(n);
    return count_.data();
  }
  /// Ranks the items. @return the sum of the counts; waits for it. expected: what an executor that only counts buffers
  /// is to take for it.
  Index rank(Index expected = 0) {
    if (count_.size() == 0) return 0;
    rank_items();
    return executor_->counts_only() ? expected : block_.get(block_.size() - 1);
  }
  /// Ranks the items without waiting; to (of the executor, or null): the sum of the counts.
  void rank_to(Index* to) {
    if (count_.size() == 0) {
      if (to) executor_->fill_bytes(to, 0, sizeof(Index));
      return;
    }
    rank_items();
    if (to) executor_->copy(to, block_.data() + block_.size() - 1, sizeof(Index));
  }
  Places places() const { return {rank_.data(), block_.data()}; }
  /// The marked items, ascending, where counts are 0 or 1; n as rank() returned it.
  void list(Index n, exec::Buffer<std::uint32_t>& out) {
    out.fit(n);
    executor_->each(count_.size(), ListMarked{count_.data(), places(), out.data()});
  }
  void free() {
    count_.free();
    rank_.free();
    block_.free();
  }

 private:
  void rank_items() {
    const Index n = count_.size(), n_blocks = (n + exec::block_threads - 1) / exec::block_threads;
    rank_.fit(n);
    block_.fit(n_blocks + 1);
    executor_->blocks(n_blocks, RankItems{count_.data(), rank_.data(), block_.data(), n, n_blocks});
    executor_->exclusive_scan(block_.data(), n_blocks + 1);
  }

  exec::Executor* executor_;
  exec::Buffer<std::uint8_t> count_;
  exec::Buffer<std::uint16_t> rank_;
  exec::Buffer<Index> block_;
};

}  // namespace bb::resident
