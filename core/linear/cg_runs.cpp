#include "core/linear/cg_runs.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/linear/cg_ritz.hpp"

namespace bb {
namespace {

/// The first run of a solve that could not begin.
bool had_nothing(const CgRun& run) {
  return run.state.end == CgEnd::zero || run.state.end == CgEnd::no_preconditioner ||
         !is_finite(run.goal.b_norm);
}

/// What a run ended with, once the true residual is known; nothing where another run may do better. curvature: the
/// verdict where it was the end. last: the true residual before this run.
std::optional<LinearStatus> judge(const CgRun& run, LinearStatus curvature, double residual, double last) {
  const CgEnd end = run.state.end;
  if (curvature == LinearStatus::matrix_indefinite) return curvature;
  if (end == CgEnd::preconditioner_indefinite) return LinearStatus::preconditioner_indefinite;
  if (end == CgEnd::non_finite || curvature == LinearStatus::non_finite || !is_finite(residual)) {
    return LinearStatus::non_finite;
  }
  if (residual <= run.goal.target) return LinearStatus::ok;
  if (end == CgEnd::cap) return LinearStatus::iteration_cap;
  // The recurrence claims more than the solution holds. Start again from the true residual while that helps.
  if (end == CgEnd::curvature || residual > 0.5 * last) return LinearStatus::tolerance_below_rounding;
  return {};
}

}  // namespace

void CgRuns::add_ritz(LinearReport& report) const {
  const RitzExtremes run = cg_ritz_extremes(alpha_, beta_);
  if (run.max == 0) return;
  report.ritz_min = report.ritz_max == 0 ? run.min : std::min(report.ritz_min, run.min);
  report.ritz_max = std::max(report.ritz_max, run.max);
}

// Of a curvature p^T A p that gives no step.
LinearStatus CgRuns::judge_curvature(double curvature) {
  if (!is_finite(curvature)) return LinearStatus::non_finite;
  // 256 eps sum |terms|: a negative sign inside this bound may be rounding, beyond it cannot.
  const double scale = curvature_magnitude();
  const double rounding = 256 * std::numeric_limits<double>::epsilon() * scale;
  return curvature < -rounding || scale == 0 ? LinearStatus::matrix_indefinite
                                             : LinearStatus::tolerance_below_rounding;
}

LinearStatus CgRuns::solve_by_runs(LinearReport& report) {
  double last = std::numeric_limits<double>::infinity();
  for (bool first = true;; first = false, ++report.restarts) {
    const CgRun done = run();
    if (first && had_nothing(done)) {
      if (done.state.end == CgEnd::zero) return LinearStatus::ok;
      report.residual_true = report.residual_recurrence = 1;
      return done.state.end == CgEnd::no_preconditioner ? LinearStatus::preconditioner_indefinite
                                                        : LinearStatus::non_finite;
    }
    const LinearStatus curvature =
        done.state.end == CgEnd::curvature ? judge_curvature(done.curvature) : LinearStatus::ok;
    add_ritz(report);
    const double residual = true_residual();
    report.iterations = done.state.iteration;
    report.residual_recurrence = std::sqrt(done.state.rr) / done.goal.b_norm;
    report.residual_true = residual / done.goal.b_norm;
    if (const auto status = judge(done, curvature, residual, last)) return *status;
    last = residual;
    restart();
  }
}

}  // namespace bb
