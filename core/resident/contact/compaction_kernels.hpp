// Places of marked items: items in blocks of 256, each item's place within its block and the sum of the blocks before.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::resident {

using exec::Index;
using exec::Key;

/// How many places come before those of item i, whatever order items run in.
struct Places {
  const std::uint16_t* rank;
  const Index* block_begin;
  BB_HD Index of(Index i) const { return block_begin[i / exec::block_threads] + rank[i]; }
};

/// rank[i]: sum of count[] over the items of the block before i. block_total[b]: over the block; 0 behind the last.
struct RankItems {
  const std::uint8_t* count;  // [n] at most 255
  std::uint16_t* rank;
  Index* block_total;  // [blocks + 1]
  Index n, n_blocks;

  struct Shared {
    int sum[2][exec::block_threads];
  };
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const RankItems k = *this;
    int *from = shared.sum[0], *to = shared.sum[1];
    block.threads([=](int t) {
      const Index i = b * exec::block_threads + t;
      from[t] = i < k.n ? k.count[i] : 0;
    });
    for (int distance = 1; distance < exec::block_threads; distance *= 2) {
      block.threads([=](int t) { to[t] = from[t] + (t >= distance ? from[t - distance] : 0); });
      int* const done = to;
      to = from;
      from = done;
    }
    block.threads([=](int t) {
      const Index i = b * exec::block_threads + t;
      if (i < k.n) k.rank[i] = static_cast<std::uint16_t>(from[t] - k.count[i]);
      if (t == exec::block_threads - 1) k.block_total[b] = from[t];
      if (t == 0 && b == 0) k.block_total[k.n_blocks] = 0;
    });
  }
};

/// out[place of i] = i where item i is marked.
struct ListMarked {
  const std::uint8_t* mark;  // 0 or 1
  Places places;
  std::uint32_t* out;
  BB_HD void operator()(Index i) const {
    if (mark[i] != 0) out[places.of(i)] = static_cast<std::uint32_t>(i);
  }
};

}  // namespace bb::resident
