// The device side of core/exec/kernel.hpp: the threads of a block, its tiles, and the two kernels that run a functor.
// Shared by the device executor and by the tests that run nvcc's PTX.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::exec {

/// HostTile on the device: every lane calls with its own value.
template <int W>
struct DeviceTile {
  static_assert(W > 0 && W <= 32 && (W & (W - 1)) == 0, "a power of two up to a warp");

  /// The lanes of this tile in the warp: tiles of one warp may diverge.
  __device__ static unsigned mask() {
    constexpr unsigned ones = 0xffffffffu >> (32 - W);
    return ones << (threadIdx.x & 31u & ~(W - 1u));
  }
  template <class F>
  __device__ auto lanes(const F& f) const {
    return f(static_cast<int>(threadIdx.x & (W - 1u)));
  }
  template <class T>
  __device__ T sum(T value) const {
#pragma unroll
    for (int distance = W / 2; distance > 0; distance /= 2) value = value + partner(value, distance);
    return value;
  }
  template <class F>
  __device__ void once(const F& f) const {
    if ((threadIdx.x & (W - 1u)) == 0) f();
  }

 private:
  template <class T>
  __device__ static T partner(const T& value, int distance) {
    if constexpr (std::is_arithmetic_v<T>) {
      return __shfl_xor_sync(mask(), value, distance);
    } else {  // a fixed-size vector or matrix
      T other;
      for (int i = 0; i < value.size(); ++i) {
        other.data()[i] = __shfl_xor_sync(mask(), value.data()[i], distance);
      }
      return other;
    }
  }
};

/// HostBlock on the device: a thread of it. All threads of the block have to come to every call.
struct DeviceBlock {
  template <class F>
  __device__ void threads(const F& f) const {
    f(static_cast<int>(threadIdx.x));
    __syncthreads();
  }
  template <class F>
  __device__ void threads(int n, const F& f) const {
    const int t = static_cast<int>(threadIdx.x);
    if (n >= block_threads || t < n) f(t);  // no comparison where n is the constant of all
    __syncthreads();
  }
  __device__ int busy(int) const { return block_threads; }
  template <class F>
  __device__ void once(const F& f) const {
    if (threadIdx.x == 0) f();
    __syncthreads();
  }
  template <int W, class F>
  __device__ void tiles(const F& f) const {
    const DeviceTile<W> tile;
    f(tile, static_cast<int>(threadIdx.x / W));
    __syncthreads();
  }
};

/// f(i) for i in [0, n): a thread an item, in blocks of block_threads or fewer (block_size.hpp).
template <class F>
__global__ void __launch_bounds__(block_threads) run_each(Index n, const __grid_constant__ F f) {
  const Index i = static_cast<Index>(blockIdx.x) * blockDim.x + static_cast<Index>(threadIdx.x);
  if (i < n) f(i);
}

/// A block of f each.
template <class F>
__global__ void __launch_bounds__(block_threads) run_blocks(const __grid_constant__ F f) {
  using Shared = typename F::Shared;
  __shared__ alignas(
      Shared) unsigned char shared[sizeof(Shared)];  // Shared may have constructors: they do not run
  const DeviceBlock block;
  f(block, *reinterpret_cast<Shared*>(shared), static_cast<Index>(blockIdx.x));
}

}  // namespace bb::exec
