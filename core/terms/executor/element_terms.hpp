// What makes the terms of this module on an executor, one function a line of core/terms/registry.inc. Called where the plan states that they are needed.
#pragma once

#include "core/terms/executor/term_inputs.hpp"

namespace bb::exec {

/// Inertia and weight are one term: a vertex is read once.
MakeOnExecutor make_inertia_on_executor, make_external_force_on_executor;
MakeOnExecutor make_pull_on_executor, make_air_drag_on_executor, make_inflation_on_executor,
    make_stitch_on_executor;
/// Errors: ConfigError for a barrier shape that is not in barriers/shapes (a plugin's has no kernel), for a policy without
/// kernel, and those of StrainLimitState.
MakeOnExecutor make_strain_limit_on_executor;

}  // namespace bb::exec
