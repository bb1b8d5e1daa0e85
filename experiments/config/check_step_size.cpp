// What steps of chosen length require of the rest of a config.
#include <fmt/format.h>

#include "core/model/integrators/registry.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/config/complain.hpp"

namespace bb {
namespace {

/// A key that is given and has no effect on steps of fixed length.
template <class T>
void check_unused(const char* place, const std::optional<T>& value, const Complain& complain) {
  if (value) complain(place, fmt::format("{}", *value), "nothing: /time/step_size is fixed");
}

}  // namespace

void check_step_size(const RunConfig& config, const Complain& complain) {
  const TimeConfig& time = config.time;
  if (time.step_size.value_or(StepSizeRule::fixed) == StepSizeRule::fixed) {
    check_unused("/time/step_iterations", time.step_iterations, complain);
    check_unused("/time/step_halvings", time.step_halvings, complain);
    check_unused("/time/step_error_m", time.step_error, complain);
    return;
  }
  const StepSolverEntry* solver = step_solvers().find(config.step_solver.name);
  if (solver && !solver->asked_to_converge) {
    complain("/time/step_size", "\"adaptive\"",
             "fixed: iterations of the step solver " + solver->name +
                 " do not count what a step costs to converge");
  }
  if (!time.step_error || !integrators().find(config.integrator.name)) return;
  if (!make_integrator(config.integrator.name)->velocity_of_step()) {
    complain(
        "/time/step_error_m", fmt::format("{}", *time.step_error),
        "nothing: the trapezoidal rule gives how large the error of an integrator of first order is, and "
        "this one is " +
            config.integrator.name);
  }
}

}  // namespace bb
