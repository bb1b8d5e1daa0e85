// Why an iteration of Newton's method was short, or its direction another one than Newton's: one cause an iteration.
#pragma once

#include <string_view>

#include "core/newton/report.hpp"

namespace bb {

/// full: the whole direction of the first matrix that the Hessian rule made. indefinite: the whole direction of a regularised matrix,
/// since the first one was not positive definite, or a move along negative curvature. contact, limit: the smaller bound, of ACCD or
/// of the strain limit, held the step, or a curved gap needed a correction. armijo: less was taken than the bound allows, since E
/// or feasibility refused more. noise: taken because the change of E was below rounding. failed: no usable direction.
enum class IterationCause { full, indefinite, contact, limit, armijo, noise, failed };
constexpr IterationCause all_iteration_causes[] = {
    IterationCause::full,   IterationCause::indefinite, IterationCause::contact, IterationCause::limit,
    IterationCause::armijo, IterationCause::noise,      IterationCause::failed};
std::string_view to_string(IterationCause cause);

/// Whether the first matrix of the iteration was refused, or the Hessian was still regularised from iterations before.
bool is_regularised(const IterationReport& report);

/// What shortened the step decides before what changed its direction. cap_fraction: the part of a binding bound that the step
/// solver takes, 1 where it has no such setting.
IterationCause cause_of(const IterationReport& report, double cap_fraction);

}  // namespace bb
