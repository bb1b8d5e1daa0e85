// `linear_solver: auto`: the solver that the cost model of this machine expects to be the fastest. Models are
// files of configs/linear_models, one a processor; ./bench fit-linear makes one.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/linear/cost_model.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// A file of configs/linear_models.
struct LinearModel {
  std::string file, cpu_model;
  std::vector<LinearCost> costs;
};
/// Errors: ConfigError for what is no such file, an unknown solver or preconditioner, a coefficient below 0,
/// no solver.
LinearModel read_linear_model(const std::string& file);

/// Replaces `auto` by what the model of this processor expects to be the fastest, with the reason in
/// linear_solver_reason; the other settings of /linear_solver stay. So a record has the solver that ran, and repeats
/// it anywhere. Any other solver stays as it is, at no cost.
/// Errors: ConfigError at /linear_solver/name without a model of this processor; those of read_linear_model and
/// build_scene. Cost: a scene, an ordering and a symbolic analysis of its elements' matrix.
void decide_linear_solver(RunConfig& config);

/// Seconds that a solve of the matrix of the elements is expected to take with the solver of the config, by the model of this
/// processor; of a solver that the model does not know, with cholmod. Nothing without a model of this processor, or where the
/// scene cannot be built. Cost: as decide_linear_solver.
std::optional<double> expected_solve_s(const RunConfig& config);

/// load_config with the linear solver decided.
RunConfig load_run(const std::string& path, std::span<const std::string> overrides);

}  // namespace bb
