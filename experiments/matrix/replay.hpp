// One stored system through every linear solver, preconditioner and condition estimator there is.
#pragma once

#include <string>
#include <vector>

#include "core/base/record/number.hpp"
#include "core/linear/condition.hpp"
#include "core/linear/linear_solver.hpp"
#include "experiments/matrix/system_file.hpp"

namespace bb {

struct ReplayOptions {
  double tol_rel = 1e-8;  // of every iterative solver, on |b - A x| / |b|
  int max_iterations = 10000;
  int dense_rows = 1500;  // at most so many rows: all eigenvalues too; 3000 at most
  std::uint64_t seed = 1;
};

struct ReplayedSolve {
  std::string solver, preconditioner;  // "none" for solvers that have no preconditioner
  LinearReport report;
};

/// How an estimate stands to the dense one of the same scaling.
enum class Agreement {
  agrees,    // both know cond, and it is the same; or neither does, for the same reason or one of its kind
  bounds,    // lower_bound, and the dense cond is not below it
  differs,   // neither of the two
  no_dense,  // too many rows, or the estimate is the dense one
};
std::string_view to_string(Agreement agreement);
/// Relative difference up to which two cond are the same: what spectra promises, beside 8 eps cond for the
/// rounding of the dense matrix.
inline constexpr double same_cond = 1e-3;

struct ReplayedEstimate {
  Estimator estimator = Estimator::spectra;  // ritz: of the Ritz values of pcg
  Scaling scaling = Scaling::none;
  ConditionEstimate estimate;
  Agreement agreement = Agreement::no_dense;
  Number cond_change_rel = Number::missing("no_dense");  // cond against the dense one, minus 1
};

struct Replay {
  std::vector<ReplayedSolve> solves;  // of the solvers that can run here, in the order of the registries
  std::vector<ReplayedEstimate> estimates;  // by estimator, then by scaling
};

/// Agreement of `estimate` with `dense`, of one matrix and scaling. not_converged agrees with nothing.
Agreement compare(const ConditionEstimate& estimate, const ConditionEstimate& dense);

/// What fails is a status of its row. Errors: ConfigError for a malformed system, which read_system refuses.
/// Cost: a solve a solver and preconditioner; the dense estimates are O(rows^3).
Replay replay(const StoredSystem& stored, const ReplayOptions& options);

}  // namespace bb
