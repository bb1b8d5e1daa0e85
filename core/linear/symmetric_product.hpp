// Products with the symmetric matrix whose lower triangle is given: both triangles as compressed rows, so
// that rows are independent and the result does not depend on the number of threads.
#pragma once

#include <vector>

#include "core/linear/block_system.hpp"
#include "core/linear/pattern_key.hpp"

namespace bb {

class SymmetricProduct {
 public:
  /// Rows and map are kept while the pattern stays. Cost: O(nonzeros). Errors: ConfigError for a matrix that
  /// is not square or has an entry above the diagonal.
  void update(const ReducedSystem& system);
  int n() const { return n_; }

  /// y = A x; y is resized and must not be x.
  void multiply(const VecXd& x, VecXd& y) const;
  /// y = A x accumulated in long double, serial: for Rayleigh quotients of ill-conditioned matrices.
  void multiply_long(const VecXd& x, std::vector<long double>& y) const;
  /// sum |p_i| |A_ij| |p_j|: scale of the rounding error of p^T A p. Serial.
  double absolute_quadratic(const VecXd& p) const;
  bool all_finite() const;

  // Rows with ascending columns.
  const std::vector<int>& row_start() const { return row_start_; }
  const std::vector<int>& column() const { return column_; }
  const std::vector<double>& value() const { return value_; }

 private:
  void build_rows(const ReducedSystem& system);

  int n_ = 0;
  PatternKey key_;
  std::vector<int> row_start_, column_, source_, cursor_;
  std::vector<double> value_;
};

}  // namespace bb
