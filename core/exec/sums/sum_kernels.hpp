// Sums and maxima over columns, as trees that depend on the number of items alone. Sums carry their rounding errors
// along, so that a small change of a large energy is not lost.
#pragma once

#include <cmath>
#include <limits>

#include "core/exec/kernel.hpp"
#include "core/exec/sums/fixed_mask.hpp"

namespace bb::exec {

/// A sum with the rounding errors of its additions beside it. Plain numbers: it lies in shared memory.
struct Compensated {
  double sum, carry, magnitude;

  BB_HD static Compensated zero() { return {0, 0, 0}; }
  /// Source: the exact rounding error of an addition, Knuth 1969.
  BB_HD void add(double part, double size) {
    const double next = sum + part, back = next - sum;
    carry += (sum - (next - back)) + (part - back);
    sum = next;
    magnitude += size;
  }
  BB_HD void add(double part) {
    using std::abs;
    add(part, abs(part));
  }
  BB_HD double value() const { return sum + carry; }
  friend BB_HD Compensated operator+(const Compensated& a, const Compensated& b) {
    Compensated out = a;
    out.add(b.sum, b.magnitude);
    out.carry += b.carry;
    return out;
  }
};

constexpr Index most_partials = 1024;

/// Items that a block of threads takes of n, so that there are at most most_partials blocks.
BB_HD inline Index items_a_block(Index n) {
  constexpr Index threads = block_threads, most = threads * most_partials;
  return threads * (n <= most ? 1 : (n + most - 1) / most);
}

/// What Parts add up: their member type Sum, or one number. A sum is plain numbers with zero(), whose bytes are all 0,
/// and +.
template <class Parts>
struct SumOf {
  using type = Compensated;
};
template <class Parts>
requires requires { typename Parts::Sum; }
struct SumOf<Parts> {
  using type = typename Parts::Sum;
};

/// What sums in blocks write: partial sums, how many of their blocks are done (0 between two launches), and the sum.
template <class Sum>
struct SumPlaces {
  Sum* partial;
  std::uint32_t* arrived;
  Sum* total;
};

/// What threads of a block share where sums meet.
template <class Sum>
struct SumShared {
  Sum at[block_threads];
  bool last;
};

/// Block b of a sum of n items: the sum of its items becomes partial[b]. Parts: as in SumParts.
template <class Block, class Sum, class Parts>
BB_HD void sum_block(Block& block, SumShared<Sum>& shared, const Parts& parts, Index n, Index b,
                     Sum* partial) {
  const Index items = items_a_block(n), end = (b + 1) * items < n ? (b + 1) * items : n;
  block.threads([&](int t) {
    Sum sum = Sum::zero();
    for (Index i = b * items + t; i < end; i += block_threads) parts(i, sum);
    shared.at[t] = sum;
  });
  fold(block, shared.at, block_threads);
  block.once([&] { partial[b] = shared.at[0]; });
}

/// *total += the sum of partial [n]: every thread adds each 256th, then a tree.
template <class Block, class Sum>
BB_HD void add_partials(Block& block, SumShared<Sum>& shared, const Sum* partial, Index n, Sum* total) {
  block.threads([&](int t) {
    Sum sum = Sum::zero();
    for (Index i = t; i < n; i += block_threads) sum = sum + partial[i];
    shared.at[t] = sum;
  });
  fold(block, shared.at, block_threads);
  block.once([&] { *total = *total + shared.at[0]; });
}

/// Whether this block is the last one of n; what all of them wrote may be read then.
template <class Block, class Sum>
BB_HD bool is_last_block(Block& block, SumShared<Sum>& shared, std::uint32_t* arrived, Index n) {
  block.once([&] { shared.last = last_to_arrive(arrived, n); });
  return shared.last;
}

BB_HD inline Index blocks_of_sum(Index n) { return (n + items_a_block(n) - 1) / items_a_block(n); }

/// *total += what the items have; the last block adds up the partial sums. Parts: a struct whose call (Index i, Sum& sum)
/// adds what item i has; it may read the total as it was before the launch.
template <class Parts>
struct SumParts {
  using Sum = typename SumOf<Parts>::type;
  using Shared = SumShared<Sum>;
  Parts parts;
  Index n;
  SumPlaces<Sum> to;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    sum_block(block, shared, parts, n, b, to.partial);
    const Index n_blocks = blocks_of_sum(n);
    if (is_last_block(block, shared, to.arrived, n_blocks))
      add_partials(block, shared, to.partial, n_blocks, to.total);
  }
};

struct LeastOf {
  BB_HD Key operator()(Key a, Key b) const { return b < a ? b : a; }
};

/// Keys whose least is the largest of some numbers, 0 at least, or the smallest of any numbers. A NaN, of whatever bits,
/// wins both.
BB_HD inline Key largest_key(double x) {
  if (x != x) return 0;
  return ~ordered_bits(x > 0 ? x : 0.0);
}
BB_HD inline Key smallest_key(double x) {
  if (x != x) return 0;
  const Key bits = ordered_bits(x), sign = Key{1} << 63;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
BB_HD inline double from_largest_key(Key key) { return from_ordered_bits(~key); }
BB_HD inline double from_smallest_key(Key key) {
  const Key sign = Key{1} << 63;
  return from_ordered_bits((key & sign) != 0 ? key & ~sign : ~key);
}

/// Numbers of a sum whose + is the greatest of two keys: complements of keys, so that 0 is none.
BB_HD inline void raise_key(Key& most, Key key) { most = key > most ? key : most; }
/// Of complements of largest_key; 0 where nothing came.
BB_HD inline double largest_of(Key most) { return most == 0 ? 0 : from_largest_key(~most); }
/// Of complements of smallest_key; infinity where nothing came.
BB_HD inline double smallest_of(Key most) {
  return most == 0 ? std::numeric_limits<double>::infinity() : from_smallest_key(~most);
}

/// *least = min(*least, keys(i) of n items).
template <class Keys>
struct LeastKey {
  struct Shared {
    Key at[block_threads];
  };
  Keys keys;
  Index n;
  Key* least;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const Index items = items_a_block(n), end = (b + 1) * items < n ? (b + 1) * items : n;
    block.threads([&](int t) {
      Key mine = ~Key{0};
      for (Index i = b * items + t; i < end; i += block_threads) {
        const Key key = keys(i);
        mine = key < mine ? key : mine;
      }
      shared.at[t] = mine;
    });
    fold(block, shared.at, block_threads, LeastOf{});
    block.once([&] { atomic_min(least, shared.at[0]); });
  }
};

// --- parts of sums
struct ColumnSum {
  const double* values;
  BB_HD void operator()(Index i, Compensated& sum) const { sum.add(values[i]); }
};
/// Energies of elements that stay: compared one by one.
struct ColumnChange {
  const double *from, *to;
  BB_HD void operator()(Index i, Compensated& sum) const {
    using std::abs;
    sum.add(to[i] - from[i], abs(from[i]) + abs(to[i]));
  }
};

/// Parts with their magnitudes.
struct ColumnParts {
  const double *part, *magnitude;
  BB_HD void operator()(Index i, Compensated& sum) const { sum.add(part[i], magnitude[i]); }
};
/// A column of a series [n]: ColumnParts, or ColumnChange, or ColumnSum of the second where the first is null.
struct SeriesColumn {
  Index n;
  const double *first, *second;
  bool parts;
};

/// Sums over one column after the other: of Lead, then of columns; each is a sum of its own (SumParts), and they are added
/// in their order. So the result is that of one launch each.
template <class Lead>
struct SumSeries {
  static constexpr int most_columns = 8;
  using Shared = SumShared<Compensated>;
  Lead lead;
  Index n_lead;
  SeriesColumn column[most_columns];
  int n_columns;
  SumPlaces<Compensated> to;  // partial: [n_blocks()]

  BB_HD Index n_blocks() const {
    Index out = blocks_of_sum(n_lead);
    for (int k = 0; k < n_columns; ++k) out += blocks_of_sum(column[k].n);
    return out;
  }
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    Index first = blocks_of_sum(n_lead);
    if (b < first) sum_block(block, shared, lead, n_lead, b, to.partial);
    for (int k = 0; k < n_columns; ++k) {
      const Index size = blocks_of_sum(column[k].n);
      if (b >= first && b < first + size) sum_column(block, shared, k, b - first, to.partial + first);
      first += size;
    }
    if (!is_last_block(block, shared, to.arrived, first)) return;
    first = blocks_of_sum(n_lead);
    if (first > 0) add_partials(block, shared, to.partial, first, to.total);
    for (int k = 0; k < n_columns; ++k) {
      const Index size = blocks_of_sum(column[k].n);
      if (size > 0) add_partials(block, shared, to.partial + first, size, to.total);
      first += size;
    }
  }

 private:
  template <class Block>
  BB_HD void sum_column(Block& block, Shared& shared, int k, Index b, Compensated* partial) const {
    const SeriesColumn& of = column[k];
    if (of.parts) {
      sum_block(block, shared, ColumnParts{of.first, of.second}, of.n, b, partial);
    } else if (of.first) {
      sum_block(block, shared, ColumnChange{of.first, of.second}, of.n, b, partial);
    } else {
      sum_block(block, shared, ColumnSum{of.second}, of.n, b, partial);
    }
  }
};

/// Two products over the same degrees of freedom.
struct TwoSums {
  Compensated first, second;
  BB_HD static TwoSums zero() { return {Compensated::zero(), Compensated::zero()}; }
  friend BB_HD TwoSums operator+(const TwoSums& a, const TwoSums& b) {
    return {a.first + b.first, a.second + b.second};
  }
};
/// Over the degrees of freedom whose bit is clear in fixed [n / 3].
struct FreeDot {
  const double *a, *b;
  const FixedMask* fixed;
  BB_HD void operator()(Index i, Compensated& sum) const {
    if (!is_fixed(fixed[i / 3], static_cast<int>(i % 3))) sum.add(a[i] * b[i]);
  }
};

// --- keys
struct ColumnSize {
  const double* values;
  BB_HD Key operator()(Index i) const {
    using std::abs;
    return largest_key(abs(values[i]));
  }
};
/// 0 at fixed degrees of freedom.
struct FreeSize {
  const double* values;
  const FixedMask* fixed;
  BB_HD Key operator()(Index i) const {
    using std::abs;
    return largest_key(!is_fixed(fixed[i / 3], static_cast<int>(i % 3)) ? abs(values[i]) : 0.0);
  }
};

}  // namespace bb::exec
