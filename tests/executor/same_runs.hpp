// Whole runs on several executors: outcomes, iterations, contacts and states are those of the host executor, bit for bit.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tests/executor/system_cases.hpp"

namespace bb::test {

/// A cloth of 4 x 4 vertices with bending and a strain limit, tilted, that settles on a floor; one corner is pulled.
inline Scene cloth_on_floor() {
  SceneBuilder builder("cloth on floor", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = test::cloth_spec(4, 0.012, 0.02);
  cloth.mesh.vertices.row(2) += 0.01 * cloth.mesh.vertices.row(0);
  cloth.material.bending = 1e-3;
  cloth.material.limit = StrainLimitSpec{0.05, 0.05};
  PinSpec corner;
  corner.indices = {0};
  corner.motion.velocity = Vec3d(0.05, 0, 0);
  cloth.pins = {corner};
  builder.add_body(cloth);
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

using MakeExecutor = std::function<std::unique_ptr<exec::Executor>()>;

inline RunEnd run_on(const Scene& scene, const std::string& shape, int steps, const MakeExecutor& make) {
  Method method = fixed_method(shape, 20);
  use_executor_solver(method);
  method.make_potential = on_executor(make);
  return run_steps(scene, std::move(method), steps);
}

/// others: beside the host executor. The run has to move, to touch and to take more than one iteration.
inline void expect_same_runs(const Scene& scene, const std::string& shape, int steps,
                             const std::vector<MakeExecutor>& others) {
  const RunEnd host = run_on(scene, shape, steps, [] { return std::make_unique<exec::HostExecutor>(); });
  EXPECT_EQ(host.status, std::vector<StepStatus>(host.status.size(), StepStatus::converged));
  EXPECT_GT(*std::max_element(host.iterations.begin(), host.iterations.end()), 1);
  ASSERT_GT(host.contacts, 0u);
  ASSERT_GT((host.x - scene.x0).cwiseAbs().maxCoeff(), 1e-3);
  ASSERT_FALSE(others.empty());
  for (const MakeExecutor& make : others) {
    SCOPED_TRACE(std::string(make()->name()));
    const RunEnd there = run_on(scene, shape, steps, make);
    EXPECT_EQ(there.status, host.status);
    EXPECT_EQ(there.iterations, host.iterations);
    EXPECT_EQ(there.contacts, host.contacts);
    EXPECT_EQ(there.x, host.x);
  }
}

}  // namespace bb::test
