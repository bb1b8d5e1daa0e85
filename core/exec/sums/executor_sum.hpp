// Sums, maxima and first items over columns of an executor. The order of the additions depends on the numbers of items
// alone.
#pragma once

#include "core/exec/board.hpp"
#include "core/exec/sums/sum_kernels.hpp"

namespace bb::exec {

/// Sum of what several calls of add bring. Reusable; cost of a call: one launch, nothing is copied.
template <class Sum>
class ExecutorSums {
 public:
  explicit ExecutorSums(Executor& executor)
      : executor_(executor),
        partial_(executor, "partial sums", most_partials),
        arrived_(executor, "blocks of sums", 1),
        total_(executor) {
    arrived_.fill_zero();
    clear();
  }
  void clear() { total_.fill(0); }
  /// Parts: sum_kernels.hpp, SumParts; their sum is a Sum.
  template <class Parts>
  void add(Index n, const Parts& parts) {
    if (n > 0) executor_.blocks(blocks_of_sum(n), SumParts<Parts>{parts, n, places()});
  }
  template <class Lead>
  void add(SumSeries<Lead> series) {
    const Index n = series.n_blocks();
    if (n == 0) return;
    partial_.resize(n > partial_.size() ? n : partial_.size());
    series.to = places();
    executor_.blocks(n, series);
  }
  /// Of the executor, for kernels that read what is known so far.
  const Sum* data() const { return total_.data(); }
  /// Waits.
  Sum get() const { return executor_.counts_only() ? Sum::zero() : total_.get(); }

 private:
  SumPlaces<Sum> places() { return {partial_.data(), arrived_.data(), total_.to_write()}; }

  Executor& executor_;
  Buffer<Sum> partial_;
  Buffer<std::uint32_t> arrived_;
  Reading<Sum> total_;
};
/// value(): the sum; magnitude: the sum of |parts|, of which rounding noise is some multiple of eps.
using ExecutorSum = ExecutorSums<Compensated>;

/// The least of keys that several calls bring: largest and smallest numbers, first items.
class ExecutorLeast {
 public:
  explicit ExecutorLeast(Executor& executor) : executor_(executor), least_(executor) { clear(); }
  void clear() { least_.fill(0xff); }
  /// Keys: sum_kernels.hpp, LeastKey.
  template <class Keys>
  void add(Index n, const Keys& keys) {
    const Index items = items_a_block(n);
    executor_.blocks((n + items - 1) / items, LeastKey<Keys>{keys, n, least_.to_write()});
  }
  /// For kernels that bring keys of their own (atomic_min).
  Key* data() { return least_.to_write(); }

  // --- what there is; all wait
  Key get() const { return executor_.counts_only() ? none : least_.get(); }
  /// Of keys made by largest_key; 0 where nothing came.
  double largest() const {
    const Key key = get();
    return key == none ? 0 : from_largest_key(key);
  }
  /// Of keys made by smallest_key; infinity where nothing came.
  double smallest() const {
    const Key key = get();
    return key == none ? std::numeric_limits<double>::infinity() : from_smallest_key(key);
  }
  /// Of keys that are items; -1 where none came.
  Index first() const {
    const Key key = get();
    return key == none ? -1 : static_cast<Index>(key);
  }

  static constexpr Key none = ~Key{0};

 private:
  Executor& executor_;
  Reading<Key> least_;
};

}  // namespace bb::exec
