// How a time step ended. A failure is a result: it is returned and recorded, never thrown.
#pragma once

#include <string_view>

namespace bb {

enum class StepStatus {
  converged,           // |dx|_inf / h < tol_velocity (accumulated_toi: the target time was reached)
  iteration_cap,       // the feasible state reached so far is kept
  step_collapse,       // the feasible step stayed below 1e-8 for 10 iterations: contact cannot carry the load
  line_search_failed,  // no sufficient decrease down to rounding
  not_descent,         // g . dx >= 0
  linear_failed,       // see the linear status
  pin_infeasible,      // a prescribed vertex cannot reach its pose
  non_finite
};

constexpr std::string_view to_string(StepStatus status) {
  switch (status) {
    case StepStatus::converged:
      return "converged";
    case StepStatus::iteration_cap:
      return "iteration_cap";
    case StepStatus::step_collapse:
      return "step_collapse";
    case StepStatus::line_search_failed:
      return "line_search_failed";
    case StepStatus::not_descent:
      return "not_descent";
    case StepStatus::linear_failed:
      return "linear_failed";
    case StepStatus::pin_infeasible:
      return "pin_infeasible";
    case StepStatus::non_finite:
      return "non_finite";
  }
  return "unknown";
}

}  // namespace bb
