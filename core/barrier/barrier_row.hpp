// A shape on its argument, for one row: what BarrierFunction (shape.hpp) is in kernels, the shape being a type.
#pragma once

#include <limits>

#include "core/barrier/normalized_gap.hpp"
#include "core/barrier/shape.hpp"
#include "core/barrier/squared_gap.hpp"
#include "core/barrier/stiffness_policy.hpp"

namespace bb {

/// BarrierFunction::eval of one row, S a struct of barriers/shapes. Equal to it bit for bit. Host-device.
template <class S, class T>
BB_HD ShapeTerms<T> barrier_row(Argument argument, bool literal, T d, T d_hat) {
  if (literal) {
    const T lowest = S::infinite_at_zero ? T(1e-10) : std::numeric_limits<T>::lowest();
    ShapeTerms<T> out = S::eval(d < lowest ? lowest : d, d_hat);
    if (!S::infinite_at_zero && d <= T(0)) out.d2b = T(0);
    return out;
  }
  if (argument == Argument::gap) return S::eval(d, d_hat);
  ShapeTerms<T> out = S::eval(d * d, d_hat * d_hat);
  chain_squared_gap(S::infinite_at_zero, d, d * d, d_hat * d_hat, out.b, out.db, out.d2b);
  return out;
}

/// A shape whose formula takes the logarithm as an argument, on numbers or on several side by side.
template <class S>
concept HasTerms = requires(const shapes::NormalizedGap<double>& gap) {
  S::terms(gap, 1.0, 1.0);
};

constexpr int rows_abreast = 4;

/// barrier_row of so many rows, not literal, with its bits. Of a host; its definition is beside the shapes
/// (barriers/shapes/lane_batch.hpp), where kernels are launched.
template <HasTerms S>
void barrier_rows(Argument argument, const double* d, const double* d_hat, double* b, double* db,
                  double* d2b);

/// FoldedBarrier::eval of one row: b its barrier, psi its potential. Host-device.
template <class T>
BB_HD ShapeTerms<T> folded_row(const ShapeTerms<T>& b, const ShapeTerms<T>& psi, const KappaPartsOf<T>& parts,
                               T d_hat) {
  const T at_d_hat = parts.per_gap_sq / (d_hat * d_hat);
  return {parts.fixed * b.b + at_d_hat * psi.b, parts.fixed * b.db + at_d_hat * psi.db,
          parts.fixed * b.d2b + at_d_hat * psi.d2b};
}

}  // namespace bb
