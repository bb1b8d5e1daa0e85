// Whether a scene starts free of intersections: every gap positive, no edge through a triangle, no point of
// the surface on the wrong side of an obstacle. The last two are judged exactly, by the audit.
#pragma once

#include <optional>

#include "core/model/scene/contact_plan.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/run_limits.hpp"

namespace bb {

/// Why there is no first step; nothing when the start is valid. `contacts` is of the scene's plan.
/// given_parts_cross: two prescribed primitives cross, at the start or where their motions take them in a step. invalid_scene: an
/// element begins beyond its strain limit, or a rest shape that moves is none at the end of a step. initial_intersection: the first other pair that touches or crosses at the start. timeout: the
/// deadline came first.
/// Cost: one audit of the surface, and one of the prescribed surface per step when prescribed bodies move
/// relative to each other or to an obstacle; of rigid bodies only what comes near another is looked at.
/// Errors: Interrupted when limits.interrupted becomes true.
std::optional<Verdict> start_failure(const RunConfig& config, const Scene& scene, const ContactPlan& contacts,
                                     const RunLimits& limits = {});

}  // namespace bb
