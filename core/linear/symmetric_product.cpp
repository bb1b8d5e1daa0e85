#include "core/linear/symmetric_product.hpp"

#include <algorithm>
#include <cmath>

#include "core/linear/parallel.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }
constexpr int kGrain = 512;  // rows a task
}  // namespace

void SymmetricProduct::update(const ReducedSystem& system) {
  if (!key_.same_as_last(system)) build_rows(system);
  const double* value = system.lower.valuePtr();
  parallel_items(static_cast<int>(value_.size()), 16384,
                 [&](int k) { value_[at(k)] = value[source_[at(k)]]; });
}

void SymmetricProduct::build_rows(const ReducedSystem& system) {
  const auto& lower = system.lower;
  if (lower.rows() != lower.cols() || !lower.isCompressed()) {
    key_.forget();
    throw ConfigError("ReducedSystem", "a matrix that is not square and compressed",
                      "lower triangle, compressed");
  }
  n_ = static_cast<int>(lower.rows());
  const int *outer = lower.outerIndexPtr(), *inner = lower.innerIndexPtr();
  row_start_.assign(at(n_) + 1, 0);
  for (int j = 0; j < n_; ++j) {
    for (int k = outer[j]; k < outer[j + 1]; ++k) {
      if (inner[k] < j) {
        key_.forget();
        throw ConfigError("ReducedSystem", "an entry above the diagonal", "lower triangle only");
      }
      ++row_start_[at(inner[k]) + 1];
      if (inner[k] != j) ++row_start_[at(j) + 1];
    }
  }
  for (int i = 0; i < n_; ++i) row_start_[at(i) + 1] += row_start_[at(i)];
  const std::size_t n_entries = at(row_start_[at(n_)]);
  column_.resize(n_entries);
  source_.resize(n_entries);
  value_.resize(n_entries);
  cursor_.assign(row_start_.begin(), row_start_.end() - 1);
  // Columns in ascending order: row i receives its entries left of the diagonal first, all ascending.
  for (int j = 0; j < n_; ++j) {
    for (int k = outer[j]; k < outer[j + 1]; ++k) {
      const auto put = [&](int row, int col) {
        const std::size_t slot = at(cursor_[at(row)]++);
        column_[slot] = col;
        source_[slot] = k;
      };
      put(inner[k], j);
      if (inner[k] != j) put(j, inner[k]);
    }
  }
}

void SymmetricProduct::multiply(const VecXd& x, VecXd& y) const {
  y.resize(n_);
  parallel_items(n_, kGrain, [&](int i) {
    double sum = 0;
    for (int k = row_start_[at(i)]; k < row_start_[at(i) + 1]; ++k) sum += value_[at(k)] * x[column_[at(k)]];
    y[i] = sum;
  });
}

void SymmetricProduct::multiply_long(const VecXd& x, std::vector<long double>& y) const {
  y.resize(at(n_));
  parallel_items(n_, kGrain, [&](int i) {
    long double sum = 0;
    for (int k = row_start_[at(i)]; k < row_start_[at(i) + 1]; ++k) {
      sum += static_cast<long double>(value_[at(k)]) * x[column_[at(k)]];
    }
    y[at(i)] = sum;
  });
}

double SymmetricProduct::absolute_quadratic(const VecXd& p) const {
  double total = 0;
  for (int i = 0; i < n_; ++i) {
    double sum = 0;
    for (int k = row_start_[at(i)]; k < row_start_[at(i) + 1]; ++k) {
      sum += std::abs(value_[at(k)] * p[column_[at(k)]]);
    }
    total += sum * std::abs(p[i]);
  }
  return total;
}

bool SymmetricProduct::all_finite() const {
  return std::all_of(value_.begin(), value_.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace bb
