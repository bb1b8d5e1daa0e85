// Kernels that test the path to the card: what their arguments look like, how many items there are, what they do wrong.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::device_kernels {

using exec::Index;
using exec::Key;

/// Arguments of every size, with holes between them.
struct ManyArguments {
  signed char tiny;
  double* out;
  short small;
  double table[30];
  std::uint32_t* flags;
  float single;
  Key* least;
  BB_HD void operator()(Index i) const {
    const double x = table[i % 30] * static_cast<double>(single) + static_cast<double>(tiny * small + i);
    out[i] = x / (1 + static_cast<double>(i));
    exec::atomic_or(flags, 1u << (i % 32));
    exec::atomic_add(flags + 1, static_cast<std::uint32_t>(i));
    exec::atomic_min(least, exec::ordered_bits(out[i]));
  }
};

struct Square {
  double* x;
  BB_HD void operator()(Index i) const { x[i] = x[i] * x[i]; }
};

/// [256 b, 256 b + 256) summed by tiles of 32, 8 and a fold.
struct BlockSums {
  struct Shared {
    double tile[32], warp[8];
  };
  const double* in;
  double* out;  // [2 b]
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.template tiles<8>([&](auto& tile, int k) {
      const auto mine = tile.lanes([&](int lane) { return in[256 * b + 8 * k + lane]; });
      const double sum = tile.sum(mine);
      tile.once([&] { shared.tile[k] = sum; });
    });
    block.template tiles<32>([&](auto& tile, int k) {
      const auto mine = tile.lanes([&](int lane) { return in[256 * b + 32 * k + lane]; });
      const double sum = tile.sum(mine);
      tile.once([&] { shared.warp[k] = sum; });
    });
    exec::fold(block, shared.tile, 32);
    exec::fold(block, shared.warp, 8);
    block.threads([&](int t) {
      if (t == 0) out[2 * b] = shared.tile[0];
      if (t == 1) out[2 * b + 1] = shared.warp[0];
    });
  }
};

/// Writes behind its array.
struct OutOfBounds {
  double* x;
  BB_HD void operator()(Index i) const { x[i + (Index{1} << 40)] = 1; }
};

/// In no list.
struct Unlisted {
  double* x;
  BB_HD void operator()(Index i) const { x[i] = 1; }
};

}  // namespace bb::device_kernels
