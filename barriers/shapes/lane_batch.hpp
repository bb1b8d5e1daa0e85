// The batch call of a shape that is made of a logarithm, four rows at a time. Not for plugins: it needs more of this
// program than a shape does.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/barrier/barrier_row.hpp"
#include "core/math/lanes_log.hpp"

namespace bb {

namespace detail {

/// Four numbers from `column` on, or m < 4 of them and the first again.
inline Lanes<double, 4> load_four(const double* column, std::size_t m) {
  if (m == 4) return load_lanes<4>(column);
  double padded[4];
  for (std::size_t k = 0; k < 4; ++k) padded[k] = column[k < m ? k : 0];
  return load_lanes<4>(padded);
}
inline void store_four(const Lanes<double, 4>& x, std::size_t m, double* column) {
  if (m == 4) return store_lanes(x, column);
  for (std::size_t k = 0; k < m; ++k) column[k] = x.v[k];
}

}  // namespace detail

/// With the bits of shape_batch: what a row gets depends on that row alone, not on those beside it.
template <HasTerms S>
void lane_batch(void*, std::size_t n, const double* d, const double* d_hat, double* b, double* db,
                double* d2b) {
  using Real = Lanes<double, 4>;
  for (std::size_t begin = 0; begin < n; begin += 4) {
    const std::size_t m = std::min<std::size_t>(4, n - begin);
    const Real gaps = detail::load_four(d + begin, m), widths = detail::load_four(d_hat + begin, m);
    const shapes::NormalizedGap<Real> gap(gaps, widths);
    const ShapeTerms<Real> terms = S::terms(gap, widths, elementary::minus_log_of(gap.u, gap.e));
    detail::store_four(terms.b, m, b + begin);
    detail::store_four(terms.db, m, db + begin);
    detail::store_four(terms.d2b, m, d2b + begin);
    const Real::Mask ordinary = gap.u > Real(0x1p-1000) && gap.e > Real(0);
    if (!any(!ordinary)) continue;
    for (std::size_t k = 0; k < m; ++k) {  // contact, and rows that do not act
      if (ordinary.bits[k] != 0) continue;
      const std::size_t i = begin + k;
      const ShapeTerms<double> one = S::eval(d[i], d_hat[i]);
      b[i] = one.b;
      db[i] = one.db;
      d2b[i] = one.d2b;
    }
  }
}

template <HasTerms S>
void barrier_rows(Argument argument, const double* d, const double* d_hat, double* b, double* db,
                  double* d2b) {
  constexpr std::size_t n = rows_abreast;
  if (argument == Argument::gap) return lane_batch<S>(nullptr, n, d, d_hat, b, db, d2b);
  double d_sq[n], d_hat_sq[n];
  for (std::size_t k = 0; k < n; ++k) d_sq[k] = d[k] * d[k], d_hat_sq[k] = d_hat[k] * d_hat[k];
  lane_batch<S>(nullptr, n, d_sq, d_hat_sq, b, db, d2b);
  for (std::size_t k = 0; k < n; ++k)
    chain_squared_gap(S::infinite_at_zero, d[k], d_sq[k], d_hat_sq[k], b[k], db[k], d2b[k]);
}

/// Evaluates a built-in shape by lane_batch where it can.
template <class S>
void use_lanes(Shape& shape) {
  if constexpr (HasTerms<S>) shape.batch_double = &lane_batch<S>;
}

}  // namespace bb
