// A scene that one quasi-static step has brought to rest, assembled there: how its forces answer to a stiffness.
#pragma once

#include "core/step_solvers/simulation.hpp"
#include "experiments/run/stiffness_answer.hpp"
#include "tests/experiments/calibrated.hpp"

namespace bb::test {

/// Calls read(scene, x, system, dt) where the step of a config ended: x in m, dt in s.
template <class Read>
void at_rest(const std::string& config_text, Read&& read) {
  const RunConfig config = parsed(config_text.c_str(), {});
  const Scene scene = build_scene(config);
  Method method = make_method(config, {});
  Simulation simulation(scene, method, config.time.dt, 1);
  StepObserver nobody;
  const StepReport report = simulation.step(nobody);
  EXPECT_EQ(report.status, StepStatus::converged) << report.detail;
  NewtonSystem system(scene, method);
  Prediction prediction;
  prediction.x_tilde = simulation.history().x;
  system.begin_step(simulation.history().x, prediction, config.time.dt, 1.0);
  system.assemble();
  read(scene, simulation.history().x, system, config.time.dt);
}

}  // namespace bb::test
