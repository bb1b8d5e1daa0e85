#include "core/linear/symmetric_product.hpp"

#include <algorithm>
#include <cmath>

#include "core/linear/block_starts.hpp"
#include "core/linear/parallel.hpp"
#include "core/math/at.hpp"
#include "core/math/error.hpp"
#include "core/math/lanes.hpp"

namespace bb {
namespace {
constexpr int rows_a_task = 256;  // block rows a task
using RowSum = Lanes<double, 4>;
}  // namespace

void SymmetricProduct::update(const ReducedSystem& system) {
  if (!key_.same_as_last(system)) {
    try {
      build_rows(system);
    } catch (...) {
      key_.forget();
      throw;
    }
  }
  parallel_items(n_blocks(), rows_a_task, [&](int c) { take_column(system.lower, c); });
}

// The entries of a block column, which come in ascending rows, and their mirror images.
void SymmetricProduct::take_column(const Eigen::SparseMatrix<double>& lower, int c) {
  const int *outer = lower.outerIndexPtr(), *inner = lower.innerIndexPtr();
  const double* value = lower.valuePtr();
  const int first = start_[at(c)], size = start_[at(c) + 1] - first;
  int next[3] = {}, beyond[3] = {};  // of each column
  for (int j = 0; j < size; ++j) next[j] = outer[first + j], beyond[j] = outer[first + j + 1];
  for (int b = lower_start_[at(c)]; b < lower_start_[at(c) + 1]; ++b) {
    const int begin = start_[at(lower_row_[at(b)])], end = start_[at(lower_row_[at(b)]) + 1];
    double *block = value_.data() + 9 * at(lower_at_[at(b)]),
           *mirror = value_.data() + 9 * at(upper_at_[at(b)]);
    for (int j = 0; j < size; ++j) {
      const int k = next[j];
      if (end - begin == 3 && k + 3 <= beyond[j] && inner[k] == begin && inner[k + 2] == begin + 2) {
        for (int i = 0; i < 3; ++i) block[3 * i + j] = mirror[3 * j + i] = value[k + i];
        next[j] = k + 3;
        continue;
      }
      for (; next[j] < beyond[j] && inner[next[j]] < end; ++next[j]) {
        const int i = inner[next[j]] - begin;
        block[3 * i + j] = mirror[3 * j + i] = value[next[j]];
      }
    }
  }
}

void SymmetricProduct::build_rows(const ReducedSystem& system) {
  if (system.lower.rows() != system.lower.cols() || !system.lower.isCompressed()) {
    throw ConfigError("ReducedSystem", "a matrix that is not square and compressed",
                      "lower triangle, compressed");
  }
  lower_block_columns(system, lower_start_, lower_row_);
  n_ = static_cast<int>(system.lower.rows());
  start_ = system.block_start;
  row_start_.assign(at(n_blocks()) + 1, 0);
  for (int c = 0; c < n_blocks(); ++c) {
    for (int k = lower_start_[at(c)]; k < lower_start_[at(c) + 1]; ++k) {
      ++row_start_[at(lower_row_[at(k)]) + 1];
      if (lower_row_[at(k)] != c) ++row_start_[at(c) + 1];
    }
  }
  for (int r = 0; r < n_blocks(); ++r) row_start_[at(r) + 1] += row_start_[at(r)];
  column_.resize(at(row_start_.back()));
  lower_at_.resize(lower_row_.size());
  upper_at_.resize(lower_row_.size());
  cursor_.assign(row_start_.begin(), row_start_.end() - 1);
  // Columns in ascending order: a row receives its blocks left of the diagonal first, all ascending.
  for (int c = 0; c < n_blocks(); ++c) {
    for (int k = lower_start_[at(c)]; k < lower_start_[at(c) + 1]; ++k) {
      const int r = lower_row_[at(k)];
      lower_at_[at(k)] = upper_at_[at(k)] = cursor_[at(r)];
      column_[at(cursor_[at(r)]++)] = c;
      if (r == c) continue;
      upper_at_[at(k)] = cursor_[at(c)];
      column_[at(cursor_[at(c)]++)] = r;
    }
  }
  value_.assign(9 * column_.size() + 1, 0.0);
  x_.assign(4 * at(n_blocks()), 0.0);
}

void SymmetricProduct::multiply(const VecXd& x, VecXd& y) const {
  y.resize(n_);
  parallel_items(n_blocks(), 4 * rows_a_task, [&](int b) {
    for (int i = start_[at(b)]; i < start_[at(b) + 1]; ++i) x_[4 * at(b) + at(i - start_[at(b)])] = x[i];
  });
  parallel_items(n_blocks(), rows_a_task, [&](int r) {
    RowSum row0(0.0), row1 = row0, row2 = row0;  // the fourth sum is of no meaning
    for (int k = row_start_[at(r)]; k < row_start_[at(r) + 1]; ++k) {
      const RowSum v = load_lanes<4>(x_.data() + 4 * at(column_[at(k)]));
      const double* a = block(k);
      row0 += load_lanes<4>(a) * v;
      row1 += load_lanes<4>(a + 3) * v;
      row2 += load_lanes<4>(a + 6) * v;
    }
    const double sums[] = {row0[0] + row0[1] + row0[2], row1[0] + row1[1] + row1[2],
                           row2[0] + row2[1] + row2[2]};
    const int begin = start_[at(r)], size = start_[at(r) + 1] - begin;
    for (int i = 0; i < size; ++i) y[begin + i] = sums[i];
  });
}

// f(degree of freedom, degree of freedom, entry) for the entries of a block row.
template <class F>
void SymmetricProduct::for_row(int row, const F& f) const {
  for (int k = row_start_[at(row)]; k < row_start_[at(row) + 1]; ++k) {
    const int c = column_[at(k)];
    for (int i = start_[at(row)]; i < start_[at(row) + 1]; ++i) {
      for (int j = start_[at(c)]; j < start_[at(c) + 1]; ++j) {
        f(i, j, block(k)[3 * (i - start_[at(row)]) + j - start_[at(c)]]);
      }
    }
  }
}

void SymmetricProduct::multiply_long(const VecXd& x, std::vector<long double>& y) const {
  y.assign(at(n_), 0.0L);
  parallel_items(n_blocks(), rows_a_task, [&](int r) {
    for_row(r, [&](int i, int j, double a) { y[at(i)] += static_cast<long double>(a) * x[j]; });
  });
}

double SymmetricProduct::absolute_quadratic(const VecXd& p) const {
  double total = 0;
  for (int r = 0; r < n_blocks(); ++r) {
    for_row(r, [&](int i, int j, double a) { total += std::abs(p[i] * a * p[j]); });
  }
  return total;
}

bool SymmetricProduct::all_finite() const {
  return std::all_of(value_.begin(), value_.end(), [](double v) { return std::isfinite(v); });
}

double SymmetricProduct::bytes() const {
  const double blocks = static_cast<double>(column_.size());
  return blocks * (9 * sizeof(double) + sizeof(int)) + 2.0 * n_ * sizeof(double);
}

}  // namespace bb
