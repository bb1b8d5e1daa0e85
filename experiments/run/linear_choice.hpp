// `linear_solver: auto`: a solver by the number of unknowns.
#pragma once

#include <span>
#include <string>

#include "experiments/config/run_config.hpp"

namespace bb {

/// Replaces `auto` by lagged_cholesky below 1000 unknowns and by pcg from there on, with the reason in linear_solver_reason; the
/// other settings of /linear_solver stay. So a record has the solver that ran, and repeats it anywhere. Any other solver stays as
/// it is, at no cost. docs/theory/newton.md has the measurement behind it.
/// Errors: those of build_scene. Cost: a scene.
void decide_linear_solver(RunConfig& config);

/// load_config with the linear solver decided.
RunConfig load_run(const std::string& path, std::span<const std::string> overrides);

}  // namespace bb
