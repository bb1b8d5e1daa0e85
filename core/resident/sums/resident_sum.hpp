// Sums, maxima and first items over columns of an executor. The order of the additions depends on the numbers of items
// alone.
#pragma once

#include "core/exec/buffer.hpp"
#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

/// Sum of what several calls of add bring. Reusable; cost of a call: one pass, nothing is copied.
template <class Sum>
class ResidentSums {
 public:
  explicit ResidentSums(exec::Executor& executor)
      : executor_(executor), partial_(executor, "partial sums", most_partials), total_(executor, "sum", 1) {
    clear();
  }
  void clear() { total_.fill_zero(); }
  /// Parts: sum_kernels.hpp, SumParts; their sum is a Sum.
  template <class Parts>
  void add(Index n, const Parts& parts) {
    if (n == 0) return;
    const Index n_blocks = (n + items_a_block(n) - 1) / items_a_block(n);
    executor_.blocks(n_blocks, SumParts<Parts>{parts, n, partial_.data()});
    executor_.blocks(1, FoldPartials<Sum>{partial_.data(), n_blocks, total_.data()});
  }
  /// Of the executor, for kernels that read what is known so far.
  const Sum* data() const { return total_.data(); }
  /// Waits.
  Sum get() const { return executor_.counts_only() ? Sum::zero() : total_.get(0); }

 private:
  exec::Executor& executor_;
  exec::Buffer<Sum> partial_, total_;
};
/// value(): the sum; magnitude: the sum of |parts|, of which rounding noise is some multiple of eps.
using ResidentSum = ResidentSums<Compensated>;

/// The least of several kinds of keys, read together.
template <int N>
class ResidentLeasts {
 public:
  static constexpr Key none = ~Key{0};
  struct Keys {
    Key of[N];
    /// Of keys made by largest_key; 0 where nothing came.
    double largest(int kind) const { return of[kind] == none ? 0 : from_largest_key(of[kind]); }
    /// Of keys made by smallest_key; infinity where nothing came.
    double smallest(int kind) const {
      return of[kind] == none ? std::numeric_limits<double>::infinity() : from_smallest_key(of[kind]);
    }
  };
  explicit ResidentLeasts(exec::Executor& executor)
      : executor_(executor), least_(executor, "least keys", 1) {}
  void clear() { executor_.fill_bytes(least_.data(), 0xff, sizeof(Keys)); }
  /// Keys: sum_kernels.hpp, LeastKey.
  template <class KeysOf>
  void add(int kind, Index n, const KeysOf& keys) {
    const Index items = items_a_block(n);
    executor_.blocks((n + items - 1) / items, LeastKey<KeysOf>{keys, n, least_.data()->of + kind});
  }
  /// Waits.
  Keys get() const {
    if (!executor_.counts_only()) return least_.get(0);
    Keys out;
    for (Key& key : out.of) key = none;
    return out;
  }

 private:
  exec::Executor& executor_;
  exec::Buffer<Keys> least_;
};

/// The least of keys that several calls bring: largest and smallest numbers, first items.
class ResidentLeast {
 public:
  explicit ResidentLeast(exec::Executor& executor) : executor_(executor), least_(executor, "least key", 1) {
    clear();
  }
  void clear() { executor_.fill_bytes(least_.data(), 0xff, sizeof(Key)); }
  /// Starts from a key.
  void clear(Key key) { least_.set(0, key); }
  /// Keys: sum_kernels.hpp, LeastKey.
  template <class Keys>
  void add(Index n, const Keys& keys) {
    const Index items = items_a_block(n);
    executor_.blocks((n + items - 1) / items, LeastKey<Keys>{keys, n, least_.data()});
  }
  /// For kernels that bring keys of their own (atomic_min).
  Key* data() { return least_.data(); }

  // --- what there is; all wait
  Key get() const { return executor_.counts_only() ? none : least_.get(0); }
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
  exec::Executor& executor_;
  exec::Buffer<Key> least_;
};

}  // namespace bb::resident
