// The inverse of a Cholesky factor of a 3x3 block, and what to call a block that has none.
#pragma once

#include <cmath>

#include <cfloat>

#include "core/linear/executor/pcg_scalars.hpp"

namespace bb::exec {

enum class FactorStatus { ok, singular, indefinite, non_finite };

/// L of d = L L^T; l[0, 6): l00, l10, l11, l20, l21, l22. False where a pivot is not above `rounding` times its
/// diagonal entry, or not positive.
BB_HD inline bool factorize_block(const Mat3d& d, double rounding, double* l) {
  for (int c = 0; c < 3; ++c) {
    for (int r = c; r < 3; ++r) {
      double sum = d(r, c);
      for (int k = 0; k < c; ++k) sum -= l[r * (r + 1) / 2 + k] * l[c * (c + 1) / 2 + k];
      if (r == c) {
        if (!(sum > rounding * d(c, c) && sum > 0)) return false;
        l[c * (c + 1) / 2 + c] = std::sqrt(sum);
      } else {
        l[r * (r + 1) / 2 + c] = sum / l[c * (c + 1) / 2 + c];
      }
    }
  }
  return true;
}

/// w = L^-1, in the order of l. With it M^-1 r = w^T (w r), which is positive definite however it is rounded.
BB_HD inline FactorStatus inverse_factor(const Mat3d& d, double* w) {
  double norm = 0;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      if (!is_finite(d(r, c))) return FactorStatus::non_finite;
      norm += d(r, c) * d(r, c);
    }
  }
  norm = std::sqrt(norm);
  double l[6];
  // A pivot below the rounding of its own subtraction shows nothing.
  if (!factorize_block(d, 4 * DBL_EPSILON, l)) {
    // Semidefinite within rounding: definite with the rounding of its eigenvalues added.
    Mat3d shifted = d;
    for (int c = 0; c < 3; ++c) shifted(c, c) += 32 * DBL_EPSILON * norm;
    return norm == 0 || factorize_block(shifted, 0, l) ? FactorStatus::singular : FactorStatus::indefinite;
  }
  w[0] = 1 / l[0], w[2] = 1 / l[2], w[5] = 1 / l[5];
  w[1] = -l[1] * w[0] * w[2];
  w[4] = -l[4] * w[2] * w[5];
  w[3] = -(l[3] * w[0] + l[4] * w[1]) * w[5];
  return FactorStatus::ok;
}

/// Keeps the lowest number with each fault.
BB_HD inline void report_fault(FactorFaults* faults, FactorStatus status, Index number) {
  const Key key = static_cast<Key>(number);
  if (status == FactorStatus::non_finite) atomic_min(&faults->non_finite, key);
  if (status == FactorStatus::indefinite) atomic_min(&faults->indefinite, key);
  if (status == FactorStatus::singular) atomic_min(&faults->singular, key);
}

/// The sum of the diagonal blocks of a vertex in both parts, rows and columns of fixed degrees of freedom those of
/// the identity.
BB_HD inline Mat3d diagonal_block(const ExecutorMatrix& matrix, FixedMask fixed, Index v) {
  Mat3d d = Mat3d::Zero();
  for (const MatrixPart& part : matrix.part) {
    if (!part.row_begin) continue;
    for (Index j = part.row_begin[v]; j < part.row_begin[v + 1]; ++j) {
      if (part.column[j] != v) continue;
      for (int c = 0; c < 9; ++c) d(c % 3, c / 3) += part.value[value_index(j, c)];
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (!is_fixed(fixed, i)) continue;
    for (int k = 0; k < 3; ++k) d(i, k) = d(k, i) = 0;
    d(i, i) = 1;
  }
  return d;
}

}  // namespace bb::exec
