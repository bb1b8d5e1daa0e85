// Sums and maxima over columns, as trees that depend on the number of items alone. Sums carry their rounding errors
// along, so that a small change of a large energy is not lost.
#pragma once

#include <cmath>

#include "core/resident/linear/resident_matrix.hpp"

namespace bb::resident {

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
  constexpr Index threads = exec::block_threads, most = threads * most_partials;
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

/// One partial sum a block. Parts: a struct whose call (Index i, Sum& sum) adds what item i has.
template <class Parts>
struct SumParts {
  using Sum = typename SumOf<Parts>::type;
  struct Shared {
    Sum at[exec::block_threads];
  };
  Parts parts;
  Index n;
  Sum* partial;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const Index items = items_a_block(n), end = (b + 1) * items < n ? (b + 1) * items : n;
    block.threads([&](int t) {
      Sum sum = Sum::zero();
      for (Index i = b * items + t; i < end; i += exec::block_threads) parts(i, sum);
      shared.at[t] = sum;
    });
    exec::fold(block, shared.at, exec::block_threads);
    block.threads([&](int t) {
      if (t == 0) partial[b] = shared.at[0];
    });
  }
};

/// *total += the partial sums; one block.
template <class Sum>
struct FoldPartials {
  struct Shared {
    Sum at[exec::block_threads];
  };
  const Sum* partial;
  Index n;
  Sum* total;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index) const {
    block.threads([&](int t) {
      Sum sum = Sum::zero();
      for (Index i = t; i < n; i += exec::block_threads) sum = sum + partial[i];
      shared.at[t] = sum;
    });
    exec::fold(block, shared.at, exec::block_threads);
    block.threads([&](int t) {
      if (t == 0) *total = *total + shared.at[0];
    });
  }
};

/// Keys whose least is the largest of some numbers, 0 at least, or the smallest of any numbers. A NaN, of whatever bits,
/// wins both.
BB_HD inline Key largest_key(double x) {
  if (x != x) return 0;
  return ~exec::ordered_bits(x > 0 ? x : 0.0);
}
BB_HD inline Key smallest_key(double x) {
  if (x != x) return 0;
  const Key bits = exec::ordered_bits(x), sign = Key{1} << 63;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}
BB_HD inline double from_largest_key(Key key) { return exec::from_ordered_bits(~key); }
BB_HD inline double from_smallest_key(Key key) {
  const Key sign = Key{1} << 63;
  return exec::from_ordered_bits((key & sign) != 0 ? key & ~sign : ~key);
}

/// *least = min(*least, keys(i) of n items).
template <class Keys>
struct LeastKey {
  struct Shared {
    Key at[exec::block_threads];
  };
  Keys keys;
  Index n;
  Key* least;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const Index items = items_a_block(n), end = (b + 1) * items < n ? (b + 1) * items : n;
    block.threads([&](int t) {
      Key mine = ~Key{0};
      for (Index i = b * items + t; i < end; i += exec::block_threads) {
        const Key key = keys(i);
        mine = key < mine ? key : mine;
      }
      shared.at[t] = mine;
    });
    for (int half = exec::block_threads / 2; half > 0; half /= 2) {
      block.threads([&](int t) {
        if (t < half && shared.at[t + half] < shared.at[t]) shared.at[t] = shared.at[t + half];
      });
    }
    block.threads([&](int t) {
      if (t == 0) exec::atomic_min(least, shared.at[0]);
    });
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

}  // namespace bb::resident
