// What makes the terms of this room on an executor, one function a line of core/terms/registry.inc. Called where the plan says that they are needed.
#pragma once

#include "core/resident/elements/term_inputs.hpp"

namespace bb::resident {

/// Inertia and weight are one term: a vertex is read once.
MakeResident make_resident_inertia, make_resident_external_force;
MakeResident make_resident_pull, make_resident_air_drag, make_resident_inflation, make_resident_stitch;
/// Errors: ConfigError for a barrier shape that is not in barriers/shapes (a plugin's has no kernel), for a policy without
/// kernel, and those of StrainLimitState.
MakeResident make_resident_strain_limit;

}  // namespace bb::resident
