// The one word a run ends with. A failure is a result: it is named, recorded and plotted.
#pragma once

#include <array>
#include <string_view>

#include "core/base/record/field.hpp"

namespace bb {

/// Ranked, most specific first: when several hold, the first in this order is the outcome. But a run that time or memory
/// cut off is not over: oom, kernel_failed and timeout stay what they are.
enum class Outcome {
  invalid_scene,      // no first step
  given_parts_cross,  // prescribed primitives cross each other, which no solver decides; most often no first step
  initial_intersection,  // no first step
  penetration,           // the audit found a crossing or a violation
  nan,                   // a non-finite energy, gradient or state
  pin_infeasible,        // a driven vertex cannot reach its pose
  ccd_cap,               // the step bound hit its probe cap and gave no progress
  stall_overload,        // no progress with the contact load above the shape's capacity
  newton_stall,          // a step ended at its iteration cap
  linear_failure,        // the linear solver broke down
  not_pd,                // the matrix was not positive definite
  oom,                   // memory ran out; the steps before count
  kernel_failed,         // a kernel of the device failed; the steps before count
  timeout,               // the time limit of the run was reached between two steps
  unproven,              // finished, but the audit could not certify every motion
  ok                     // finished; an overlap that the step solver promises to keep to is no failure
};
template <>
inline constexpr int n_words<Outcome> = 16;

constexpr std::string_view to_string(Outcome outcome) {
  constexpr std::array<std::string_view, n_words<Outcome>> words = {"invalid_scene",
                                                                    "given_parts_cross",
                                                                    "initial_intersection",
                                                                    "penetration",
                                                                    "nan",
                                                                    "pin_infeasible",
                                                                    "ccd_cap",
                                                                    "stall_overload",
                                                                    "newton_stall",
                                                                    "linear_failure",
                                                                    "not_pd",
                                                                    "oom",
                                                                    "kernel_failed",
                                                                    "timeout",
                                                                    "unproven",
                                                                    "ok"};
  return words[static_cast<std::size_t>(outcome)];
}

/// The one of two that a run reports.
inline Outcome worse(Outcome a, Outcome b) { return a < b ? a : b; }

}  // namespace bb
