// A linear solver of the Newton step: A x = b, A symmetric positive definite. Breakdown is a status
// with its cause.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/linear/block_system.hpp"
#include "core/linear/definiteness.hpp"
#include "core/linear/forcing.hpp"

namespace bb {

class Archive;

/// A Cholesky factor has more entries than the indices of its library hold. what() reports how large the matrix is.
struct FactorTooLarge : std::length_error {
  using std::length_error::length_error;
};

enum class LinearStatus {
  ok,
  matrix_indefinite,          // not positive definite: failed pivot, or p^T A p < 0 beyond rounding
  preconditioner_indefinite,  // r^T M^-1 r <= 0
  tolerance_below_rounding,   // stagnated at the attainable accuracy, above the tolerance
  non_finite,
  iteration_cap,
  factor_too_large  // more entries than the library of the factor can number
};
std::string_view to_string(LinearStatus status);

struct LinearReport {
  LinearStatus status = LinearStatus::ok;
  bool iterative = false;
  std::string detail;              // what about the matrix made it fail, where that is known
  int iterations = 0;              // 0 for direct solvers
  double tolerance = 0;            // on residual_true, as chosen for this solve; 0 for direct solvers
  double residual_true = 0;        // |b - A x| / |b|, 2-norm
  double residual_recurrence = 0;  // the same from the recurrence (iterative)
  double ritz_min = 0,
         ritz_max = 0;  // of the preconditioned matrix, from the CG coefficients; 0 when not available
  bool analyzed = false, factorized = false;
  int restarts = 0;                        // pcg: times the true residual replaced a drifted recurrence
  int preconditioner_shifts = 0;           // ic0: factorisations of A + shift diag(A) after a breakdown
  double preconditioner_shift = 0;         // ic0: the shift in use
  double factor_nnz = 0, factor_flop = 0;  // of a Cholesky factor that was made for this solve, else 0
  double analyze_s = 0, factor_s = 0, solve_s = 0;
};

struct LinearOptions {
  std::string name = "cholmod";
  ParameterMap
      parameters;  // of the solver of that name and of its preconditioner; what is left out has its default
};

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  virtual std::string_view name() const = 0;
  /// A step begins: what earlier right-hand sides report of the tolerance no longer holds.
  virtual void begin_step() {}
  /// Whether it reads ReducedSystem::mesh where there is one.
  virtual bool wants_mesh() const { return false; }
  /// What earlier solves decide of later ones: clusters, the matrix that an earlier factor is of, the pattern that was
  /// analysed. A solver that read it goes on as the one that wrote it, bit for bit. Cost: at most a copy of a matrix.
  virtual void keep(Archive&) {}
  /// x is resized to b. Analysis is reused while pattern_id stays. Never silently falls back
  /// to another method. A factor that is too large is the status factor_too_large.
  /// of: what b is; how far an inexact solve goes depends on it.
  /// Errors: ConfigError when b has not one entry a row of the matrix; std::bad_alloc.
  LinearReport solve(const ReducedSystem& system, const VecXd& b, VecXd& x,
                     RightSide of = RightSide::residual);
  /// Whether A is positive definite: a direct solver by its factor, an iterative one by its own iterations. near: for
  /// the preconditioner. What solve() keeps from earlier matrices may change. Cost: a factorisation, two more and
  /// some solves where there is none; or a solve to 1e-6.
  virtual Definiteness examine(const ReducedSystem& a, const NearMatrix& near);
  /// The same of the matrix that the last solve() was given, by what that solve has set up. Nothing where it set up nothing that serves, or a
  /// call of examine() came between. Cost: a solve to 1e-6 without its set-up.
  virtual std::optional<Definiteness> examine_solved() { return std::nullopt; }

 protected:
  RightSide right_side() const { return of_; }  // of the solve that runs

 private:
  RightSide of_ = RightSide::residual;
  /// x is 0, b fits.
  virtual LinearReport solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) = 0;
};

}  // namespace bb
