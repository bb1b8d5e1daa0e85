// Columns of a check: an item reads its numbers from `in` and writes all that it computes to `out`.
#pragma once

#include "core/exec/kernel.hpp"

namespace bb::device_check {

template <class T>
struct Slots {
  const T* in;
  T* out;

  /// The next value or matrix of the input.
  template <class M>
  BB_HD M read() {
    M m;
    for (int i = 0; i < m.size(); ++i) m.data()[i] = *in++;
    return m;
  }
  BB_HD T scalar() { return *in++; }
  BB_HD T positive() {
    const T x = *in++;
    return x < T(0) ? -x : x;
  }

  BB_HD void write(T value) { *out++ = value; }
  template <int R, int C>
  BB_HD void write(const Mat<T, R, C>& m) {
    for (int i = 0; i < m.size(); ++i) *out++ = m.data()[i];
  }
};

/// A check is a kernel on items; most need less than this.
template <class T>
struct Columns {
  static constexpr exec::Index n_in = 256, n_out = 1024;  // numbers of an item
  const T* in;
  T* out;
  BB_HD Slots<T> slots(exec::Index i) const { return {in + n_in * i, out + n_out * i}; }
};

}  // namespace bb::device_check
