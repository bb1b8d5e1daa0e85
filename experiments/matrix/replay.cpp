#include "experiments/matrix/replay.hpp"

#include <cmath>
#include <limits>

#include "core/base/parameters/parameter.hpp"
#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {
namespace {

constexpr Scaling scalings[] = {Scaling::none, Scaling::jacobi, Scaling::block_jacobi};

bool has(const std::vector<Parameter>& rows, std::string_view name) {
  for (const Parameter& row : rows) {
    if (row.name == name) return true;
  }
  return false;
}

ReplayedSolve solve(const LinearSolverEntry& entry, const std::string& preconditioner,
                    const StoredSystem& stored, const ReplayOptions& options) {
  LinearOptions how;
  how.name = entry.name;
  set_preconditioner(entry, preconditioner, how.parameters);
  if (has(entry.parameters, "forcing")) how.parameters["forcing"] = std::string("fixed");
  if (has(entry.parameters, "tol_rel")) how.parameters["tol_rel"] = options.tol_rel;
  if (has(entry.parameters, "max_iterations")) how.parameters["max_iterations"] = options.max_iterations;
  VecXd x;
  return {entry.name, preconditioner, make_linear_solver(how)->solve(stored.system, stored.rhs, x)};
}

/// ritz, from a solve that was preconditioned by a scaling.
ConditionEstimate from_solve(const LinearReport& report) {
  ConditionEstimate e = condition_from_ritz(report.ritz_min, report.ritz_max);
  if (report.status == LinearStatus::matrix_indefinite) {
    e.status = ConditionStatus::not_pd;
    e.cond = std::numeric_limits<double>::quiet_NaN();  // a ratio of positive Ritz values bounds nothing
  }
  e.seconds = report.solve_s;
  return e;
}

void add_ritz(Replay& out) {
  for (const Scaling scaling : scalings) {
    for (const ReplayedSolve& solve : out.solves) {
      if (solve.solver != "pcg" || solve.preconditioner != to_string(scaling)) continue;
      ReplayedEstimate row;
      row.estimator = Estimator::ritz;
      row.scaling = scaling;
      row.estimate = from_solve(solve.report);
      out.estimates.push_back(std::move(row));
    }
  }
}

void compare_with_dense(Replay& out) {
  for (ReplayedEstimate& row : out.estimates) {
    if (row.estimator == Estimator::dense) continue;
    for (const ReplayedEstimate& dense : out.estimates) {
      if (dense.estimator != Estimator::dense || dense.scaling != row.scaling) continue;
      row.agreement = compare(row.estimate, dense.estimate);
      const bool both = std::isfinite(row.estimate.cond) && std::isfinite(dense.estimate.cond);
      row.cond_change_rel =
          both ? Number(row.estimate.cond / dense.estimate.cond - 1) : Number::missing("no_cond");
    }
  }
}

}  // namespace

std::string_view to_string(Agreement agreement) {
  switch (agreement) {
    case Agreement::agrees:
      return "agrees";
    case Agreement::bounds:
      return "bounds";
    case Agreement::differs:
      return "differs";
    case Agreement::no_dense:
      return "no_dense";
  }
  return "";
}

Agreement compare(const ConditionEstimate& estimate, const ConditionEstimate& dense) {
  // Rounding decides on which side of 0 the smallest eigenvalue of a singular matrix is found, and whether it
  // is one of 1e-16 or 1e-15 of the largest.
  const auto beyond = [](const ConditionEstimate& e) {
    return e.status == ConditionStatus::singular || e.status == ConditionStatus::not_pd ||
           (e.status == ConditionStatus::lower_bound && e.cond >= largest_known_cond);
  };
  const auto indefinite = [](const ConditionEstimate& e) {
    return e.status == ConditionStatus::not_pd && e.lambda_min < -1e-12 * std::abs(e.lambda_max);
  };
  // The dense matrix is scaled in double: that alone moves its smallest eigenvalue by some eps of the largest.
  const double known = std::isfinite(dense.cond) ? dense.cond : 0;
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * known;
  if (estimate.status == ConditionStatus::ok && dense.status == ConditionStatus::ok) {
    const bool same = std::abs(estimate.cond / dense.cond - 1) <= same_cond + rounding;
    return same ? Agreement::agrees : Agreement::differs;
  }
  if (estimate.status == ConditionStatus::not_converged) return Agreement::differs;
  if (beyond(estimate) && beyond(dense)) {
    const bool told_apart = indefinite(dense) && estimate.status != ConditionStatus::not_pd;
    return told_apart ? Agreement::differs : Agreement::agrees;
  }
  if (estimate.status == ConditionStatus::lower_bound) {
    const bool below =
        dense.status == ConditionStatus::singular || estimate.cond <= dense.cond * (1 + same_cond + rounding);
    return below ? Agreement::bounds : Agreement::differs;
  }
  return Agreement::differs;
}

Replay replay(const StoredSystem& stored, const ReplayOptions& options) {
  Replay out;
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (!missing_for(entry.name).empty()) continue;
    for (const std::string& preconditioner : preconditioner_choices(entry)) {
      out.solves.push_back(solve(entry, preconditioner, stored, options));
    }
  }
  add_ritz(out);
  ConditionEstimator conditions;
  for (const Estimator estimator :
       {Estimator::inverse_power, Estimator::spectra, Estimator::lanczos, Estimator::dense}) {
    if (estimator == Estimator::dense && stored.system.lower.rows() > options.dense_rows) continue;
    for (const Scaling scaling : scalings) {
      ReplayedEstimate row;
      row.estimator = estimator;
      row.scaling = scaling;
      row.estimate = conditions.estimate(stored.system,
                                         {.estimator = estimator, .scaling = scaling, .seed = options.seed});
      out.estimates.push_back(std::move(row));
    }
  }
  compare_with_dense(out);
  return out;
}

}  // namespace bb
