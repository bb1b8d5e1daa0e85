// A sparse Cholesky factor by cuDSS, on a card.
#pragma once

#include <functional>
#include <memory>

#include "core/exec/buffer.hpp"
#include "core/linear/cudss/factor_memory.hpp"
#include "core/linear/cudss/library.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/linear/pattern_key.hpp"

namespace bb::cudss {

/// The lower triangle by columns is, to cuDSS, the upper triangle by rows. Not for two threads at a time.
class Factor {
 public:
  /// library: usable. Errors: ConfigError without a usable card; exec::ExecutionError with the call that failed and its
  /// status.
  explicit Factor(const Library& library);

  /// Factorises A; the analysis is kept while pattern_id stays.
  /// @return ok | matrix_indefinite | non_finite (an entry of A)
  /// Errors: exec::OutOfMemory, exec::ExecutionError.
  LinearStatus factorize(const ReducedSystem& system);
  /// x = A^-1 b with the last factor, which must be ok. Errors: as factorize.
  void solve(const VecXd& b, VecXd& x);

  /// Why the last factorize is matrix_indefinite. cuDSS reports no row.
  std::string failure(const ReducedSystem& system) const;
  bool analyzed_last() const { return analyzed_last_; }
  double analyze_s() const { return analyze_s_; }  // of the last factorize, with the upload of the pattern
  double factor_s() const { return factor_s_; }    // with the upload of the values
  double factor_nonzeros() const { return factor_nonzeros_; }
  double factor_flops() const { return 0; }  // not known

 private:
  template <class T>
  using Owned = std::unique_ptr<T, std::function<void(T*)>>;
  void make_handle();
  void configure();
  void set_pattern(const ReducedSystem& system);
  void analyze();
  LinearStatus run_factorization();
  void execute(cudssPhase_t phase, const char* what);
  void check(cudssStatus_t status, const char* what);

  Library library_;
  std::unique_ptr<exec::Executor> executor_;  // what follows lives in its memory
  FactorMemory memory_;
  exec::Buffer<int> row_start_, column_;
  exec::Buffer<double> value_, b_, x_;
  Owned<cudssContext> handle_;  // before what is made with it
  Owned<cudssConfig> config_;
  Owned<cudssData> data_;
  Owned<cudssMatrix> matrix_, rhs_, solution_;
  PatternKey key_;
  bool analyzed_ = false;  // the pattern of the key
  bool analyzed_last_ = false;
  int info_ = 0;  // CUDSS_DATA_INFO of the last factorisation
  double analyze_s_ = 0, factor_s_ = 0, factor_nonzeros_ = 0;
};

}  // namespace bb::cudss
