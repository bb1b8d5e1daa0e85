// A shape on its argument: the implementation of core/barrier/shape.hpp, one code for float and double.
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/barrier/shape.hpp"
#include "core/barrier/squared_gap.hpp"
#include "core/math/lanes.hpp"

namespace bb {
namespace {

void call(const Shape& shape, std::size_t n, const double* d, const double* d_hat, double* b, double* db,
          double* d2b) {
  shape.batch_double(shape.self, n, d, d_hat, b, db, d2b);
}
void call(const Shape& shape, std::size_t n, const float* d, const float* d_hat, float* b, float* db,
          float* d2b) {
  shape.batch_float(shape.self, n, d, d_hat, b, db, d2b);
}

/// chain_squared_gap of m rows, four at a time in double: the same operations, and the same bits.
template <class T>
void chain_rows(bool infinite_at_zero, std::size_t m, const T* d, const T* d_sq, const T* d_hat_sq, T* b,
                T* db, T* d2b) {
  std::size_t begin = 0;
  if constexpr (std::is_same_v<T, double>) {
    using Real = Lanes<double, 4>;
    const auto load = [&](const double* column) { return load_lanes<4>(column + begin); };
    const auto store = [&](const Real& x, double* column) { store_lanes(x, column + begin); };
    for (; begin + 4 <= m; begin += 4) {
      const Real square = load(d_sq), width = load(d_hat_sq), slope = load(db);
      if (any(square == Real(0))) break;
      store((Real(2) * slope + Real(4) * square * load(d2b)) / width, d2b);
      store(Real(2) * load(d) * slope / width, db);
      store(load(b) / width, b);
    }
  }
  for (std::size_t i = begin; i < m; ++i) {
    chain_squared_gap(infinite_at_zero, d[i], d_sq[i], d_hat_sq[i], b[i], db[i], d2b[i]);
  }
}

// The article's clamp hides penetration: its log has a constant force below 1e-10, its cubic no curvature.
template <class T>
void eval_literal(const Shape& shape, std::size_t n, const T* d, const T* d_hat, T* b, T* db, T* d2b) {
  constexpr std::size_t chunk = 128;
  const T lowest = shape.infinite_at_zero ? T(1e-10) : std::numeric_limits<T>::lowest();
  T clamped[chunk];
  for (std::size_t start = 0; start < n; start += chunk) {
    const std::size_t m = std::min(chunk, n - start);
    for (std::size_t i = 0; i < m; ++i) clamped[i] = std::max(d[start + i], lowest);
    call(shape, m, clamped, d_hat + start, b + start, db + start, d2b + start);
    for (std::size_t i = start; i < start + m; ++i) {
      if (!shape.infinite_at_zero && d[i] <= 0) d2b[i] = 0;
    }
  }
}

template <class T>
void eval_batch(const BarrierFunction& fn, std::size_t n, const T* d, const T* d_hat, T* b, T* db, T* d2b) {
  if (fn.literal) {
    eval_literal(fn.shape, n, d, d_hat, b, db, d2b);
    return;
  }
  if (fn.argument == Argument::gap) {
    call(fn.shape, n, d, d_hat, b, db, d2b);
    return;
  }
  constexpr std::size_t chunk = 128;  // two stack columns of at most 1 KiB
  T d_sq[chunk], d_hat_sq[chunk];
  for (std::size_t start = 0; start < n; start += chunk) {
    const std::size_t m = std::min(chunk, n - start);
    for (std::size_t i = 0; i < m; ++i) {
      d_sq[i] = d[start + i] * d[start + i];
      d_hat_sq[i] = d_hat[start + i] * d_hat[start + i];
    }
    call(fn.shape, m, d_sq, d_hat_sq, b + start, db + start, d2b + start);
    chain_rows(fn.shape.infinite_at_zero, m, d + start, d_sq, d_hat_sq, b + start, db + start, d2b + start);
  }
}

/// Columns of doubles in float.
void eval_narrowed(const BarrierFunction& fn, std::size_t n, const double* d, const double* d_hat, double* b,
                   double* db, double* d2b) {
  constexpr std::size_t chunk = 128;
  float in[2][chunk], out[3][chunk];
  for (std::size_t start = 0; start < n; start += chunk) {
    const std::size_t m = std::min(chunk, n - start);
    for (std::size_t i = 0; i < m; ++i) {
      in[0][i] = static_cast<float>(d[start + i]);
      in[1][i] = static_cast<float>(d_hat[start + i]);
    }
    eval_batch(fn, m, in[0], in[1], out[0], out[1], out[2]);
    for (std::size_t i = 0; i < m; ++i) {
      b[start + i] = out[0][i];
      db[start + i] = out[1][i];
      d2b[start + i] = out[2][i];
    }
  }
}

template <class T>
ShapeTerms<T> eval_one(const BarrierFunction& fn, T d, T d_hat) {
  ShapeTerms<T> terms;
  fn.eval(1, &d, &d_hat, &terms.b, &terms.db, &terms.d2b);
  return terms;
}

}  // namespace

void BarrierFunction::eval(std::size_t n, const double* d, const double* d_hat, double* b, double* db,
                           double* d2b) const {
  if (in_float) return eval_narrowed(*this, n, d, d_hat, b, db, d2b);
  eval_batch(*this, n, d, d_hat, b, db, d2b);
}
void BarrierFunction::eval(std::size_t n, const float* d, const float* d_hat, float* b, float* db,
                           float* d2b) const {
  eval_batch(*this, n, d, d_hat, b, db, d2b);
}
ShapeTerms<double> BarrierFunction::eval(double d, double d_hat) const { return eval_one(*this, d, d_hat); }
ShapeTerms<float> BarrierFunction::eval(float d, float d_hat) const { return eval_one(*this, d, d_hat); }

std::string_view to_string(Argument argument) { return argument == Argument::gap ? "gap" : "squared_gap"; }

}  // namespace bb
