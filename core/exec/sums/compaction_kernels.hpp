// Places of counted items: items in blocks of 256, each item's place within its block and the sum of the blocks before.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::exec {

/// How many places come before those of item i, whatever order items run in.
struct Places {
  const std::uint16_t* rank;
  const Index* block_begin;
  BB_HD Index of(Index i) const { return block_begin[i / block_threads] + rank[i]; }
};

/// Two sorts of places at once, of at most one an item each: of both in one number, the first in its lower half.
struct TwoPlaces {
  const std::uint16_t* rank;
  const Index* block_begin;
  BB_HD Index first(Index i) const { return first_of(block_begin[i / block_threads]) + (rank[i] & 0xff); }
  BB_HD Index second(Index i) const { return second_of(block_begin[i / block_threads]) + (rank[i] >> 8); }
  /// Of a number that a scan of the blocks has made.
  BB_HD static Index first_of(Index both) { return both & 0xffffffff; }
  BB_HD static Index second_of(Index both) { return both >> 32; }
};

/// Where the items of a block get their places.
struct RankPlaces {
  std::uint16_t* rank;  // [n]
  Index* block_total;   // [blocks + 1]; 0 behind the last
  Index n, n_blocks;
};

struct RankShared {
  int sum[2][block_threads];
};

/// Ranks the items of block b. counts(i): how many places item i has, at most 255; of two sorts 0 or 1 of the first plus
/// 2^16 of the second.
template <bool two, class Block, class Counts>
BB_HD void rank_block(Block& block, RankShared& shared, const RankPlaces& to, Index b, const Counts& counts) {
  int *from = shared.sum[0], *into = shared.sum[1];
  block.threads([&](int t) {
    const Index i = b * block_threads + t;
    from[t] = i < to.n ? counts(i) : 0;
  });
  for (int distance = 1; distance < block_threads; distance *= 2) {
    block.threads([=](int t) { into[t] = from[t] + (t >= distance ? from[t - distance] : 0); });
    int* const done = into;
    into = from;
    from = done;
  }
  block.threads([&](int t) {
    const Index i = b * block_threads + t;
    const int before = t > 0 ? from[t - 1] : 0;
    if (i < to.n)
      to.rank[i] = static_cast<std::uint16_t>(two ? (before & 0xff) | (before >> 16) << 8 : before);
    const Index all = from[t];
    if (t == block_threads - 1) to.block_total[b] = two ? (all & 0xffff) | (all >> 16) << 32 : all;
    if (t == 0 && b == 0) to.block_total[to.n_blocks] = 0;
  });
}

/// Counts: a struct whose call (Index i) is what rank_block() counts; two: whether it has two sorts.
template <class Counts>
struct RankItems {
  using Shared = RankShared;
  Counts counts;
  RankPlaces to;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    rank_block<Counts::two>(block, shared, to, b, counts);
  }
};

/// Counts that a kernel has written.
struct StoredCounts {
  static constexpr bool two = false;
  const std::uint8_t* count;  // [n] at most 255
  BB_HD int operator()(Index i) const { return count[i]; }
};

}  // namespace bb::exec
