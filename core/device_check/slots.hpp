// Memory of a check kernel: values are read from `in` and written to `out`, so that nothing
// is optimised away.
#pragma once

#include "core/math/types.hpp"

namespace bb::device_check {

template <class T>
struct Slots {
  const T* in;
  T* out;

  /// The next value or matrix of the input.
  template <class M>
  __device__ M read() {
    M m;
    for (int i = 0; i < m.size(); ++i) m.data()[i] = *in++;
    return m;
  }
  __device__ T scalar() { return *in++; }

  __device__ void write(T value) { *out++ = value; }
  template <int R, int C>
  __device__ void write(const Mat<T, R, C>& m) {
    for (int i = 0; i < m.size(); ++i) *out++ = m.data()[i];
  }
};

}  // namespace bb::device_check

/// Instantiates kernel<T>(const T*, T*), for both scalars where BB_DEVICE_CHECK_FLOAT is defined.
#ifdef BB_DEVICE_CHECK_FLOAT
#define BB_DEVICE_CHECK(...)                                            \
  template __global__ void __VA_ARGS__<double>(const double*, double*); \
  template __global__ void __VA_ARGS__<float>(const float*, float*)
#else
#define BB_DEVICE_CHECK(...) template __global__ void __VA_ARGS__<double>(const double*, double*)
#endif
