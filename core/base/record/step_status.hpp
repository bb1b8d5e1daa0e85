// How a time step ended. A failure is a result: it is returned and recorded, never thrown.
#pragma once

#include <array>
#include <string_view>

#include "core/base/record/field.hpp"

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
template <>
inline constexpr int n_words<StepStatus> = 8;

/// What is known of the second derivatives of E where a step ended.
enum class EndProof {
  not_checked,  // the step did not converge, or /step_solver/saddle is ignore
  factor,       // positive definite: a Cholesky factor of the exact matrix exists
  lanczos,   // positive definite: conjugate gradients on a seeded right-hand side met no negative curvature
  clamped,   // some term's exact Hessian is not known; what is known curves upwards
  unproven,  // neither was shown
  saddle,    // not positive definite: a direction of negative curvature is known
  cusp       // no minimum: E has no derivative there, and falls from it
};
template <>
inline constexpr int n_words<EndProof> = 7;

constexpr std::string_view to_string(EndProof proof) {
  constexpr std::array<std::string_view, n_words<EndProof>> words = {
      "not_checked", "factor", "lanczos", "clamped", "unproven", "saddle", "cusp"};
  return words[static_cast<std::size_t>(proof)];
}
/// Whether it is known that the end is no minimum.
constexpr bool is_no_minimum(EndProof proof) { return proof == EndProof::saddle || proof == EndProof::cusp; }

constexpr std::string_view to_string(StepStatus status) {
  constexpr std::array<std::string_view, n_words<StepStatus>> words = {
      "converged",   "iteration_cap", "step_collapse",  "line_search_failed",
      "not_descent", "linear_failed", "pin_infeasible", "non_finite"};
  return words[static_cast<std::size_t>(status)];
}

}  // namespace bb
