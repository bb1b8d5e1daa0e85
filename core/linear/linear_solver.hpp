// A linear solver of the Newton step: A x = b, A symmetric positive definite. Breakdown is a status with its
// cause.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/linear/block_system.hpp"

namespace bb {

enum class LinearStatus {
  ok,
  matrix_indefinite,          // not positive definite: failed pivot, or p^T A p < 0 beyond rounding
  preconditioner_indefinite,  // r^T M^-1 r <= 0
  tolerance_below_rounding,   // stagnated at the attainable accuracy, above the tolerance
  non_finite,
  iteration_cap
};
std::string_view to_string(LinearStatus status);

struct LinearReport {
  LinearStatus status = LinearStatus::ok;
  int iterations = 0;              // 0 for direct solvers
  double residual_true = 0;        // |b - A x| / |b|, 2-norm
  double residual_recurrence = 0;  // the same from the recurrence (iterative)
  double ritz_min = 0,
         ritz_max = 0;  // of the preconditioned matrix, from the CG coefficients; 0 when not available
  bool analyzed = false, factorized = false;
  int restarts = 0;                 // pcg: times the true residual replaced a drifted recurrence
  int preconditioner_shifts = 0;    // ic0: factorisations of A + shift diag(A) after a breakdown
  double preconditioner_shift = 0;  // ic0: the shift in use
  double analyze_s = 0, factor_s = 0, solve_s = 0;
};

struct LinearOptions {
  std::string name = "cholmod";
  std::string preconditioner = "block_jacobi";  // pcg: none, jacobi, block_jacobi, ic0
  double tol_rel = 1e-8;                        // pcg: |r| <= tol_rel |b|
  int max_iterations = 10000;
};

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  virtual std::string_view name() const = 0;
  /// x is resized to b. Analysis is reused while pattern_id stays. Never silently falls back to another
  /// method.
  virtual LinearReport solve(const ReducedSystem& system, const VecXd& b, VecXd& x) = 0;
};

/// Throws ConfigError for an unknown name, listing the registry.
std::unique_ptr<LinearSolver> make_linear_solver(const LinearOptions& options);

struct LinearSolverEntry {
  std::string_view name, doc;
};
/// The registry, in its order.
const std::vector<LinearSolverEntry>& linear_solvers();
/// Preconditioners that pcg knows.
const std::vector<std::string_view>& preconditioners();
/// " (did you mean NAME?)" for the nearest name by edit distance, or "" when none is near.
std::string did_you_mean(std::string_view found, const std::vector<std::string_view>& names);

}  // namespace bb
