// Incomplete Cholesky factor with the pattern of A: M = L L^T.
#pragma once

#include <vector>

#include "core/linear/preconditioner.hpp"

namespace bb {

/// A breakdown (a pivot that is not positive) is retried with A + shift diag(A), shift = 1e-3 and then four
/// times the last one, eight times at most; retries are counted and the shift reported. Serial.
/// Source: Meijerink, van der Vorst 1977; shift: Manteuffel 1980, sequence after Lin, More 1999.
class Ic0 final : public Preconditioner {
 public:
  /// @return ok | matrix_indefinite (a diagonal entry <= 0) | preconditioner_indefinite (all
  /// shifts broke down)
  LinearStatus setup(const ReducedSystem& system, const SymmetricProduct& rows) override;
  void apply(const VecXd& r, VecXd& z) const override;
  int shifts() const override { return shifts_; }
  double shift() const override { return shift_; }

 private:
  bool factorize(double shift);

  int n_ = 0, shifts_ = 0;
  double shift_ = 0;
  std::vector<int> start_, column_;  // rows of L, ascending, the diagonal last
  std::vector<double> a_, l_;        // lower entries of A and of L
  std::vector<double> work_;         // [n] row in progress, 0 elsewhere
};

}  // namespace bb
