// Kernels for the tests of executors, on the host and on the device.
#pragma once

#include <cmath>

#include "core/exec/kernel.hpp"

namespace bb::sample {

using exec::Index;

struct Square {
  const double* in;
  double* out;
  BB_HD void operator()(Index i) const { out[i] = in[i] * in[i]; }
};

/// Sums of 256 numbers each, by tiles and a fold.
struct BlockSums {
  struct Shared {
    double tile[32];
  };
  const double* in;
  double* out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.template tiles<8>([&](auto& tile, int k) {
      const auto mine = tile.lanes([&](int lane) { return in[256 * b + 8 * k + lane]; });
      const double sum = tile.sum(mine);
      tile.once([&] { shared.tile[k] = sum; });
    });
    exec::fold(block, shared.tile, 32);
    block.once([&] { out[b] = shared.tile[0]; });
  }
};

/// The largest of the first 200 of 256 numbers: some of the threads, a fold by another sum.
struct LargestOfSome {
  static constexpr int some = 200;
  struct Shared {
    double most[exec::block_threads];
  };
  const double* in;
  double* out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.threads([&](int t) { shared.most[t] = -1e300; });
    block.threads(some, [&](int t) { shared.most[t] = in[256 * b + t]; });
    exec::fold(block, shared.most, exec::block_threads, [](double x, double y) { return y > x ? y : x; });
    block.once([&] { out[b] = shared.most[0]; });
  }
};

/// Sums of vectors over tiles of W lanes, some of which have nothing to do: tiles of a warp part ways.
template <int W>
struct TileSums {
  struct Shared {
    int unused;
  };
  const double* in;  // [3 x n]
  double* out;       // [3 x n/W]
  Index n_tiles;
  template <class Block>
  BB_HD void operator()(Block& block, Shared&, Index b) const {
    block.template tiles<W>([&](auto& tile, int k) {
      const Index mine = b * (exec::block_threads / W) + k;
      if (mine >= n_tiles || mine % 3 == 1) return;
      const auto values = tile.lanes([&](int lane) {
        const Index i = mine * W + lane;
        return Vec3d(in[3 * i], in[3 * i + 1], in[3 * i + 2]);
      });
      const Vec3d sum = tile.sum(values);
      tile.once([&] {
        for (int c = 0; c < 3; ++c) out[3 * mine + c] = sum[c];
      });
    });
  }
};

/// Integer atomics; `arrivals` counts items, whoever comes last is not seen.
struct Atomics {
  const double* in;
  exec::Key* least;
  std::uint32_t *seen, *arrivals;
  BB_HD void operator()(Index i) const {
    exec::atomic_min(least, exec::ordered_bits(in[i] < 0 ? -in[i] : in[i]));
    exec::atomic_or(seen, 1u << (i % 31));
    exec::atomic_add(arrivals, 1u);
  }
};

/// The item that arrives last adds up what all wrote: their stores come before their arrivals.
struct LastArrival {
  const double* in;
  double* square;
  std::uint32_t* arrivals;
  double* total;
  Index n;
  BB_HD void operator()(Index i) const {
    square[i] = in[i] * in[i];
    if (static_cast<Index>(exec::atomic_add(arrivals, 1u)) + 1 < n) return;
    double sum = 0;
    for (Index k = 0; k < n; ++k) sum += square[k];
    *total = sum;
  }
};

/// A walk over a heap-ordered tree with a stack of its own.
struct Walk {
  const double* in;
  double* out;
  int n;
  BB_HD void operator()(Index i) const {
    int stack[32], top = 0;
    double sum = 0;
    stack[top++] = 1;
    while (top > 0) {
      const int node = stack[--top];
      sum = sum + in[node];
      if (2 * node + 1 >= n || in[node] * static_cast<double>(i) > 40) continue;
      stack[top++] = 2 * node, stack[top++] = 2 * node + 1;
    }
    out[i] = sum;
  }
};

/// Mathematics that is a library's on both sides.
struct Library {
  const double* in;
  double* out;  // [8 x n]
  BB_HD void operator()(Index i) const {
    const double x = in[i], size = std::fabs(x), positive = size + 1e-3;
    out[8 * i] = std::sin(x), out[8 * i + 1] = std::cos(x);
    out[8 * i + 2] = std::atan2(x, positive - 1e-3);  // the size up to rounding, 0 of 0
    out[8 * i + 3] = std::log(size), out[8 * i + 4] = std::exp(x);
    out[8 * i + 5] = std::acos(x / (size + 1)), out[8 * i + 6] = std::cbrt(x);
    out[8 * i + 7] = std::pow(size, 1.5);
  }
};

/// Integers: division, shifts, 64-bit products, a switch.
struct Integers {
  const std::uint64_t* in;
  std::int64_t* out;  // [6 x n]
  int divisor;
  BB_HD void operator()(Index i) const {
    const std::uint64_t x = in[i];
    const auto s = static_cast<std::int64_t>(x);
    const int k = static_cast<int>(x % 7);
    out[6 * i] = s / divisor, out[6 * i + 1] = s % divisor;
    out[6 * i + 2] = static_cast<std::int64_t>((x * 0x9E3779B97F4A7C15ull) >> 29) ^ (s >> 7);
    out[6 * i + 3] = static_cast<int>(x) / divisor + static_cast<int>(x >> 32) % divisor;
    std::int64_t chosen = 0;
    switch (k) {
      case 0:
        chosen = s + divisor;
        break;
      case 1:
        chosen = s * divisor;
        break;
      case 2:
        chosen = static_cast<std::int64_t>(static_cast<double>(s) * 1e-3);
        break;
      case 3:
        chosen = -s;
        break;
      case 4:
        chosen = static_cast<std::int16_t>(s);
        break;
      default:
        chosen = static_cast<std::uint8_t>(x);
    }
    out[6 * i + 4] = chosen;
    out[6 * i + 5] = static_cast<std::int64_t>(static_cast<float>(x >> 40) / 3.0f);
  }
};

}  // namespace bb::sample
