// `linear_solver: auto`: the solver that the cost model of this machine expects to be the fastest. Models are
// files of configs/linear_models, one a processor; ./bench fit-linear makes one.
#pragma once

#include <string>
#include <vector>

#include "core/linear/cost_model.hpp"
#include "core/newton/method.hpp"
#include "core/scene/scene.hpp"
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

struct LinearChoice {
  LinearOptions solver;
  std::string reason;
};
/// By the model of this processor. The other settings of /linear_solver are the config's.
/// @param method  of the config; its stiffness does not matter
/// Errors: ConfigError at /linear_solver/name without a model of this processor; those of read_linear_model.
/// Cost: an ordering and a symbolic analysis of the elements' matrix.
LinearChoice choose_linear_solver(const RunConfig& config, const Scene& scene, Method& method);

}  // namespace bb
