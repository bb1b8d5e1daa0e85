#include "experiments/run/plan.hpp"

#include "core/linear/linear_solver.hpp"
#include "core/math/error.hpp"
#include "core/newton/newton_system.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

/// The terms of the config. The numbers of their stiffness do not matter to a plan.
Method uncalibrated(const RunConfig& config) {
  Calibration any;
  any.kappa = any.k_s = any.solid_k_s = 1;
  return make_method(config, any);
}

}  // namespace

bool has_observed_run(const RunConfig& config) {
  return config.passes.diagnose || config.passes.audit || !config.passes.time ||
         config.output.frames_every > 0 || config.output.pair_forces.value_or(false);
}

Plan plan_of(const RunConfig& config, const Scene& scene) {
  PlanOptions options;
  options.step = step_solvers().require(config.step_solver.name, "/step_solver/name").needs;
  options.end_check = config.step_solver.saddle != SaddleRule::ignore;
  options.linear = {config.linear_solver.name, config.linear_solver.parameters};
  options.linear_reason = config.linear_solver_reason;
  options.diagnose = config.passes.diagnose;
  options.audit = config.passes.audit;
  options.trace = has_observed_run(config);
  options.frames = config.output.frames_every > 0;
  options.matrices = config.output.matrices;
  return make_plan(scene, uncalibrated(config), options);
}

void check_step_solver_forms(const RunConfig& config, const Scene& scene) {
  if (step_solvers().require(config.step_solver.name, "/step_solver/name").needs.matrix) return;
  Method method = uncalibrated(config);
  NewtonSystem system(scene, method, plan_of(config, scene));
  try {
    make_step_solver(method.step_solver)->require(system);
  } catch (const ConfigError& error) {
    std::vector<Violation> violations = error.violations();
    for (Violation& v : violations) v.where = config.source + "#" + v.where;
    throw ConfigError(std::move(violations));
  }
}

}  // namespace bb
