// Steps of a scene that all have to converge.
#pragma once

#include <gtest/gtest.h>

#include "core/step_solvers/simulation.hpp"

namespace bb::test {

/// The state after `steps` steps of dt (s), [3 x n] m; see(report) is called after each.
template <class See>
Positions converged_steps(const Scene& scene, Method& method, double dt, int steps, const See& see) {
  Simulation simulation(scene, method, dt, steps);
  StepObserver none;
  for (int i = 0; i < steps; ++i) {
    const StepReport report = simulation.step(none);
    EXPECT_EQ(report.status, StepStatus::converged) << i << " " << report.detail;
    see(report);
  }
  return simulation.history().x;
}

}  // namespace bb::test
