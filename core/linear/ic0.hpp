// Incomplete Cholesky factor with the pattern of A: M = L L^T.
#pragma once

#include <vector>

#include "core/linear/pattern_key.hpp"
#include "core/linear/preconditioner.hpp"

namespace bb {

/// A breakdown (a pivot that is not positive) is retried with A + shift diag(A), shift = 1e-3 and then four
/// times the last one, eight times at most; retries are counted and the shift reported. Serial.
/// Source: Meijerink, van der Vorst 1977; shift: Manteuffel 1980, sequence after Lin, More 1999.
class Ic0 final : public Preconditioner {
 public:
  /// @return ok | matrix_indefinite (a diagonal entry < 0) | preconditioner_indefinite (one is 0, or all
  /// shifts broke down)
  LinearStatus setup(const ReducedSystem& system, const SymmetricProduct& rows) override;
  void apply(const VecXd& r, VecXd& z) const override;
  std::string detail() const override { return detail_; }
  int shifts() const override { return shifts_; }
  double shift() const override { return shift_; }

 private:
  void build_rows(const Eigen::SparseMatrix<double>& lower);
  LinearStatus check_diagonal(const ReducedSystem& system);
  bool factorize(double shift);

  int n_ = 0, shifts_ = 0;
  double shift_ = 0;
  std::string detail_;
  PatternKey key_;
  std::vector<int> start_, column_;   // rows of L, ascending, the diagonal last
  std::vector<int> source_, cursor_;  // where the entries of a row are in the columns of the matrix
  std::vector<double> a_, l_;         // lower entries of A and of L
  std::vector<double> work_;          // [n] row in progress, 0 elsewhere
};

}  // namespace bb
