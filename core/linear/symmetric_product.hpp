// Products with the symmetric matrix whose lower triangle is given: rows of 3 x 3 blocks, both triangles, one
// index a block. Rows are independent, so the result does not depend on the number of threads. One triangle
// alone halves the bytes, but half of it is a scattered sum: measured at 108,000 lower blocks it was 1.2 to 1.5
// times faster on one thread and as much slower on two, at 860,000 as fast.
#pragma once

#include <vector>

#include "core/linear/block_system.hpp"
#include "core/linear/pattern_key.hpp"

namespace bb {

class SymmetricProduct {
 public:
  /// Rows and map are kept while the pattern stays. Cost: O(nonzeros). Errors: ConfigError for a matrix that
  /// is not square or has an entry above the diagonal, and for what check_block_starts refuses.
  void update(const ReducedSystem& system);
  int n() const { return n_; }

  /// y = A x; y is resized and must not be x.
  void multiply(const VecXd& x, VecXd& y) const;
  /// y = A x accumulated in long double, serial: for Rayleigh quotients of ill-conditioned matrices.
  void multiply_long(const VecXd& x, std::vector<long double>& y) const;
  /// sum |p_i| |A_ij| |p_j|: scale of the rounding error of p^T A p. Serial.
  double absolute_quadratic(const VecXd& p) const;
  bool all_finite() const;

  // Block rows with ascending columns. Blocks are stored by rows, 0 beyond the size of the vertex.
  int n_blocks() const { return static_cast<int>(start_.size()) - 1; }
  const std::vector<int>& start() const { return start_; }  // [n_blocks + 1] first degree of freedom
  const std::vector<int>& row_start() const { return row_start_; }
  const std::vector<int>& column() const { return column_; }
  const double* block(int k) const { return value_.data() + 9 * static_cast<std::size_t>(k); }
  /// Bytes that a product has to read and write at least once.
  double bytes() const;

 private:
  void build_rows(const ReducedSystem& system);
  void take_column(const Eigen::SparseMatrix<double>& lower, int c);
  template <class F>
  void for_row(int row, const F& f) const;

  int n_ = 0;
  PatternKey key_;
  std::vector<int> start_, row_start_, column_;
  std::vector<int> lower_start_, lower_row_;  // [n_blocks + 1] blocks of the lower triangle, column by column
  std::vector<int> lower_at_, upper_at_;      // where such a block and its mirror image are in column_
  std::vector<double> value_;      // [9 blocks + 1]: the last block is read four numbers at a time too
  mutable std::vector<double> x_;  // [4 n_blocks] 0 beyond the size of the vertex
  std::vector<int> cursor_;        // scratch of build_rows
};

}  // namespace bb
