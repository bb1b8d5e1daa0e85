#include "experiments/run/outcome.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bb {
namespace {

/// What is known beside the status, how often the step was halved, and whether it was done again.
std::string because(const StepReport& step) {
  std::string text = step.detail.empty() ? "" : "; " + step.detail;
  if (step.retries > 0) {
    text += fmt::format("; after {} retries, the last with {:.3g} s", step.retries, step.dt_s);
  }
  if (step.redone_audited > 0) text += "; done again with every motion bounded";
  return text;
}

/// Where the largest load over capacity is.
std::string overloaded(const StepReport& step, bool contact) {
  const std::string& at = contact ? step.contact_overload_at : step.limit_overload_at;
  return (contact ? "at a contact" : "of the strain limit") + (at.empty() ? "" : " (" + at + ")");
}

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
                        overloaded(step, contact >= limit), to_string(step.status),
                        step.newton_iterations - step.iterations_before, because(step))};
  }
  if (step.ccd_capped > step.ccd_capped_before && step.status == StepStatus::step_collapse) {
    return {Outcome::ccd_cap, fmt::format("step {}: {} pairs reached the probe cap{}", step.step,
                                          step.ccd_capped - step.ccd_capped_before, because(step))};
  }
  return {Outcome::newton_stall,
          fmt::format("step {}: {} after {} iterations{}", step.step, to_string(step.status),
                      step.newton_iterations - step.iterations_before, because(step))};
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
      return {Outcome::pin_infeasible, fmt::format("step {}: pin_infeasible{}", step.step, because(step))};
    case StepStatus::non_finite:
      return {Outcome::nan, fmt::format("step {}: not finite{}", step.step, because(step))};
    case StepStatus::linear_failed:
      return {step.detail.starts_with(to_string(LinearStatus::matrix_indefinite)) ? Outcome::not_pd
                                                                                  : Outcome::linear_failure,
              fmt::format("step {}: linear_failed{}", step.step, because(step))};
  }
  return {};
}

}  // namespace bb
