#include "experiments/run/outcome.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bb {
namespace {

std::string because(const StepReport& step) { return step.detail.empty() ? "" : "; " + step.detail; }

double load_of(const Number& overload) { return overload.finite() ? overload.value : 0; }

// No progress: because some contact or limited element carries more than its barrier can, or
// for another reason.
Verdict stalled(const StepReport& step) {
  const double contact = load_of(step.contact_overload), limit = load_of(step.limit_overload);
  const double worst = std::max(contact, limit);
  // with |dx| still falling it is the cap that ended the step, not the load
  if (worst > 1 && !step.still_falling) {
    return {Outcome::stall_overload,
            fmt::format("step {}: load over capacity {:.3g} {}; {} after {} iterations{}", step.step, worst,
                        contact >= limit ? "at a contact" : "of the strain limit", to_string(step.status),
                        step.newton_iterations, because(step))};
  }
  if (step.ccd_capped > 0 && step.status == StepStatus::step_collapse) {
    return {Outcome::ccd_cap,
            fmt::format("step {}: {} pairs reached the probe cap", step.step, step.ccd_capped)};
  }
  return {Outcome::newton_stall, fmt::format("step {}: {} after {} iterations{}", step.step,
                                             to_string(step.status), step.newton_iterations, because(step))};
}

}  // namespace

Verdict judge_step(const StepReport& step) {
  switch (step.status) {
    case StepStatus::converged:
      return {};
    case StepStatus::iteration_cap:
    case StepStatus::step_collapse:
    case StepStatus::line_search_failed:
    case StepStatus::not_descent:
      return stalled(step);
    case StepStatus::pin_infeasible:
      return {Outcome::pin_infeasible, step.detail};
    case StepStatus::non_finite:
      return {Outcome::nan, fmt::format("step {}: a non-finite direction", step.step)};
    case StepStatus::linear_failed:
      return {step.detail == to_string(LinearStatus::matrix_indefinite) ? Outcome::not_pd
                                                                        : Outcome::linear_failure,
              fmt::format("step {}: {}", step.step, step.detail)};
  }
  return {};
}

}  // namespace bb
