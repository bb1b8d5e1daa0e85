// Choices without branches, for code that runs on one number or on several side by side (lanes.hpp).
#pragma once

#include "core/math/host_device.hpp"

namespace bb {

/// The number one lane holds.
template <class T>
struct ScalarOf {
  using type = T;
};

/// What a comparison of two T gives: bool, or one truth value a lane.
template <class T>
using MaskOf = decltype(T() < T());

template <class T>
BB_HD inline T select(bool mask, T yes, T no) {
  return mask ? yes : no;
}
BB_HD inline bool any(bool mask) { return mask; }

/// select, entry by entry.
template <class Mask, class Matrix>
BB_HD inline Matrix select_entries(const Mask& mask, const Matrix& yes, const Matrix& no) {
  Matrix out;
  for (int j = 0; j < Matrix::ColsAtCompileTime; ++j) {
    for (int i = 0; i < Matrix::RowsAtCompileTime; ++i) out(i, j) = select(mask, yes(i, j), no(i, j));
  }
  return out;
}

}  // namespace bb
