// The plan of a config: the scene's needs and the options' together.
#pragma once

#include "core/terms/plan.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// True when a run is observed: for diagnose, audit or frames, or because none is timed. That run
/// leaves the trace; none of its times is reported as a time.
bool has_observed_run(const RunConfig& config);

/// Requires a decided linear solver (linear_choice.hpp).
Plan plan_of(const RunConfig& config, const Scene& scene);

/// Errors: ConfigError for what the scene has that the step solver cannot step. Cost: the terms of the scene, for a step
/// solver without matrix; nothing for others.
void check_step_solver_forms(const RunConfig& config, const Scene& scene);

}  // namespace bb
