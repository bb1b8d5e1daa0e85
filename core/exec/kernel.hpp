// What a kernel is written in. A kernel is a named struct of numbers and raw pointers, trivially copyable, with
//   each:    BB_HD void operator()(Index i) const                                          one item
//   blocks:  template <class Block> BB_HD void operator()(Block&, Shared&, Index b) const  256 threads, one block;
//            Shared is a member type: what the threads of a block share
// The same struct runs on host threads, in any order of items, blocks and threads, and on the device (executor.hpp).
// So that the order never changes a bit: an item writes its own slots; floating-point sums are trees that the kernel
// spells out (fold, Tile::sum) and a function of the sizes alone; atomics are on integers.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/math/types.hpp"

namespace bb::exec {

using Index = std::int64_t;
using Key = std::uint64_t;
constexpr int block_threads = 256;

/// In a list of kernels: F where the condition holds, else a line that names no kernel.
struct NoKernel {};
template <bool condition, class F>
using KernelWhere = std::conditional_t<condition, F, NoKernel>;

/// One value a lane, on the host.
template <class T, int W>
struct LaneValues {
  T of[W];
};

/// W neighbouring threads of a warp, W a power of two up to 32. The device's is in device_block.cuh.
template <int W>
struct HostTile {
  /// f(lane) of every lane.
  template <class F>
  auto lanes(const F& f) const {
    LaneValues<decltype(f(0)), W> out;
    for (int lane = 0; lane < W; ++lane) out.of[lane] = f(lane);
    return out;
  }
  /// The sum over the lanes, in every lane: a butterfly, halves first. All lanes add the same numbers in the same order, so
  /// here one does.
  template <class T>
  T sum(LaneValues<T, W> values) const {
    for (int half = W / 2; half > 0; half /= 2) {
      for (int lane = 0; lane < half; ++lane) values.of[lane] = values.of[lane] + values.of[lane + half];
    }
    return values.of[0];
  }
  /// f() in one lane.
  template <class F>
  void once(const F& f) const {
    f();
  }
};

/// The threads of a block. Between two calls lies a barrier: what a call wrote to Shared, the next one reads.
struct HostBlock {
  const int* order;  // [256] in which threads run; null: 0, 1, ...
  /// f(thread) of all threads.
  template <class F>
  void threads(const F& f) const {
    threads(block_threads, f);
  }
  /// f(thread) of the first n threads.
  template <class F>
  void threads(int n, const F& f) const {
    const int last = order ? block_threads : n;
    for (int i = 0; i < last; ++i) {
      const int t = order ? order[i] : i;
      if (t < n) f(t);
    }
  }
  /// How many threads to run where those from n on have nothing to do, and add +0 to a sum when they run: here n; on a
  /// device all, since there they cost nothing and a constant saves registers.
  int busy(int n) const { return n; }
  /// f() in one thread.
  template <class F>
  void once(const F& f) const {
    f();
  }
  /// f(tile, number of the tile) of all 256/W tiles.
  template <int W, class F>
  void tiles(const F& f) const {
    const HostTile<W> tile;
    threads(block_threads / W, [&](int k) { f(tile, k); });
  }
};

/// How many threads fold n numbers: the least power of two that is not below n, 256 at most.
BB_HD inline int fold_width(Index n) {
  int width = block_threads;
  while (width / 2 >= n && width > 1) width /= 2;
  return width;
}

/// a[0] = a[0] + ... + a[n - 1] with join(a, b) for +, n a power of two up to 256, a in shared memory: a tree, halves first.
template <class Block, class T, class Join>
BB_HD void fold(Block& block, T* a, int n, const Join& join) {
  for (int half = n / 2; half > 0; half /= 2) {
    block.threads(half, [=](int t) { a[t] = join(a[t], a[t + half]); });
  }
}
template <class Block, class T>
BB_HD void fold(Block& block, T* a, int n) {
  fold(block, a, n, [](const T& x, const T& y) { return x + y; });
}

/// The bits of x >= 0, which compare as x does.
BB_HD inline Key ordered_bits(double x) {
  Key bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}
BB_HD inline double from_ordered_bits(Key bits) {
  double x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

// In global memory; relaxed. The result of many is the same in any order.
BB_HD inline void atomic_min(Key* at, Key value) {
#ifdef __CUDA_ARCH__
  atomicMin(reinterpret_cast<unsigned long long*>(at), static_cast<unsigned long long>(value));
#else
  Key old = __atomic_load_n(at, __ATOMIC_RELAXED);
  while (value < old &&
         !__atomic_compare_exchange_n(at, &old, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}
BB_HD inline void atomic_or(std::uint32_t* at, std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  atomicOr(at, bits);
#else
  __atomic_fetch_or(at, bits, __ATOMIC_RELAXED);
#endif
}
/// @return what was there before: for "the second one to arrive".
BB_HD inline std::uint32_t atomic_add(std::uint32_t* at, std::uint32_t value) {
#ifdef __CUDA_ARCH__
  __threadfence();
  return atomicAdd(at, value);
#else
  return __atomic_fetch_add(at, value, __ATOMIC_ACQ_REL);
#endif
}
/// Called by one thread of each of n blocks, behind what the block wrote: true in the last one, which may read what all
/// of them wrote. *arrived is 0 before and afterwards.
BB_HD inline bool last_to_arrive(std::uint32_t* arrived, Index n) {
  const bool last = static_cast<Index>(atomic_add(arrived, 1)) == n - 1;
  if (!last) return false;
  *arrived = 0;
#ifdef __CUDA_ARCH__
  __threadfence();
#endif
  return true;
}
BB_HD inline void atomic_add(Key* at, Key value) {
#ifdef __CUDA_ARCH__
  atomicAdd(reinterpret_cast<unsigned long long*>(at), static_cast<unsigned long long>(value));
#else
  __atomic_fetch_add(at, value, __ATOMIC_RELAXED);
#endif
}

}  // namespace bb::exec
