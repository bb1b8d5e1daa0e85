// From counts of items to their places in a column without holes: count, then fill.
#pragma once

#include <string>

#include "core/exec/board.hpp"
#include "core/exec/sums/compaction_kernels.hpp"

namespace bb::exec {

/// 2 B an item, 3 where counts are stored; keeps its buffers.
class Compaction {
 public:
  Compaction(Executor& executor, const std::string& name)
      : executor_(&executor),
        count_(executor, name + " counts"),
        rank_(executor, name + " ranks"),
        block_(executor, name + " places"),
        sum_(executor) {}
  /// Memory for the counts of n items; a kernel fills them, at most 255 each.
  std::uint8_t* counts(Index n) {
    count_.fit(n);
    return count_.data();
  }
  /// Ranks items by their stored counts. @return the sum of the counts; waits for it. expected: what an executor that only
  /// counts buffers is to take for it.
  Index rank(Index expected = 0) {
    if (count_.size() == 0) return 0;
    rank_by(count_.size(), StoredCounts{count_.data()});
    return executor_->counts_only() ? expected : sum();
  }
  /// Ranks n items by what counts reports of them (RankItems), in one launch and a scan.
  template <class Counts>
  void rank_by(Index n, const Counts& counts) {
    executor_->blocks(blocks_of(n), RankItems<Counts>{counts, room(n)});
    finish(n);
  }
  /// For kernels that rank themselves: memory for n items; then finish().
  RankPlaces room(Index n) {
    rank_.fit(n);
    block_.fit(blocks_of(n) + 1);
    return {rank_.data(), block_.data(), n, blocks_of(n)};
  }
  /// After a kernel has ranked n items.
  void finish(Index n) {
    if (n == 0) {
      sum_.fill(0);
      return;
    }
    const Index n_blocks = blocks_of(n);
    executor_->exclusive_scan(block_.data(), n_blocks + 1);
    executor_->copy(sum_.to_write(), block_.data() + n_blocks, sizeof(Index));
  }
  static Index blocks_of(Index n) { return (n + block_threads - 1) / block_threads; }
  /// The sum of the counts; of two sorts as TwoPlaces has them. Waits.
  Index sum() const { return sum_.get(); }
  /// The same for kernels.
  const Index* sum_on_executor() const { return sum_.data(); }
  Places places() const { return {rank_.data(), block_.data()}; }
  TwoPlaces two_places() const { return {rank_.data(), block_.data()}; }
  void free() {
    count_.free();
    rank_.free();
    block_.free();
  }

 private:
  Executor* executor_;
  Buffer<std::uint8_t> count_;
  Buffer<std::uint16_t> rank_;
  Buffer<Index> block_;
  Reading<Index> sum_;
};

}  // namespace bb::exec
