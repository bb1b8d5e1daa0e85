// Sparse Cholesky factor of a reduced system, shared by the direct solver and the condition estimator.
#pragma once

#include <memory>
#include <string>

#include "core/linear/linear_solver.hpp"

namespace bb {

/// CHOLMOD, supernodal, ordered and analysed by vertices (block_analysis.hpp), one BLAS thread. Not copyable, one thread at a time.
class CholmodFactor {
 public:
  CholmodFactor();
  ~CholmodFactor();
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  /// Factorises A; the analysis is kept while pattern_id stays.
  /// @return ok | matrix_indefinite (a pivot is not positive) | non_finite (an entry of A)
  /// Errors: std::bad_alloc; FactorTooLarge when the factor exceeds CHOLMOD's 32-bit indices.
  LinearStatus factorize(const ReducedSystem& system);
  /// Ordering and symbolic analysis alone, of the pattern of A. Errors: as factorize.
  void analyze(const ReducedSystem& system);
  /// x = A^-1 b with the last factor, which must be ok. Allocates nothing after the first solve of a size.
  void solve(const VecXd& b, VecXd& x);

  /// The pattern that was analysed: one that read it analyses that pattern again, to the same ordering, and does not say
  /// that it did.
  void keep(Archive& archive);

  /// Where the pivot was not positive in the last factorize, which is matrix_indefinite.
  std::string failure(const ReducedSystem& system) const;
  bool analyzed_last() const { return analyzed_last_; }  // the last factorize had to analyse
  double analyze_s() const { return analyze_s_; }        // of the last factorize
  double factor_s() const { return factor_s_; }
  double factor_nonzeros() const;  // of L, without the zeros of relaxed supernodes
  double factor_flops() const;     // of a factorisation, the same way

 private:
  struct Cholmod;
  std::unique_ptr<Cholmod> cholmod_;
  bool analyzed_last_ = false;
  double analyze_s_ = 0, factor_s_ = 0;
};

}  // namespace bb
