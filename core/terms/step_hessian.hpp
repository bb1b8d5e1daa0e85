// Which Hessian of a term goes into the Newton matrix: an axis of the step solver, chosen for each term by
// itself. Convex terms have no choice.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/math/projection.hpp"

namespace bb {

/// clamped: negative eigenvalues of every element set to 0. absolute: their sign changed. The others begin
/// with the exact Hessian and leave it when the matrix turns out not to be positive definite:
/// exact_or_clamped for the clamped one (Longva et al. 2023), progressive for the clamped one at vertices
/// with a large residual (as Stark does; Fernandez-Fernandez et al. 2025), blend for exact + t (clamped -
/// exact) with the smallest t that serves.
enum class StepHessian { clamped, absolute, exact_or_clamped, progressive, blend };
constexpr StepHessian all_step_hessians[] = {StepHessian::clamped, StepHessian::absolute,
                                             StepHessian::exact_or_clamped, StepHessian::progressive,
                                             StepHessian::blend};
std::string_view to_string(StepHessian hessian);
/// Requires a word of to_string().
StepHessian step_hessian_of(std::string_view word);

/// How a term is linearised: those that begin with the exact Hessian clamp() when it is due.
constexpr Projection first_projection(StepHessian hessian) {
  if (hessian == StepHessian::clamped) return Projection::psd;
  return hessian == StepHessian::absolute ? Projection::absolute : Projection::none;
}

/// Of how many of the terms in use that are not convex a sum of Hessians of the first level has the exact one.
enum class ExactHessians { none, some, all };

struct TermOptions;
/// Whether a term of that name has an exact Hessian when one is requested: rows of contact leave the Hessian of the
/// gap out as gauss_newton.
bool knows_exact_hessian(std::string_view term, const TermOptions& options);

/// The choice that a term offers, as an entry of a registry: one parameter with the term's name.
struct HessianChoice {
  std::string name;
  std::vector<Parameter> parameters;
};
/// Those of all terms that are not convex, in the order of registry.inc. The parameter has no default of its
/// own: it depends on the step solver.
const std::vector<HessianChoice>& hessian_choices();

}  // namespace bb
