#include "experiments/config/step_promise.hpp"

#include "core/step_solvers/registry.hpp"

namespace bb {

double promised_overlap(const RunConfig& config) {
  const StepSolverEntry& solver = step_solvers().require(config.step_solver.name, "/step_solver/name");
  if (!solver.promised_overlap) return 0;
  return solver.promised_overlap(
      own_parameters(solver.parameters, config.step_solver.parameters, "/step_solver"));
}

bool bounds_motions(const RunConfig& config) {
  StepSolverOptions options;
  options.name = config.step_solver.name;
  options.parameters = config.step_solver.parameters;
  return bounds_motions(options);
}

}  // namespace bb
