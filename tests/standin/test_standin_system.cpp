// The whole Newton step through the compiled device executor, and through PTX alone: outcomes, iterations and states are
// those of the host executor, bit for bit.
#include <gtest/gtest.h>

#include "core/cuda/device_executor.hpp"
#include "tests/ptx/ptx_executor.hpp"
#include "tests/resident/system_cases.hpp"
#include "tests/standin/cudart.hpp"

namespace bb {
namespace {

/// A cloth of 4 x 4 vertices with bending and a strain limit, tilted, that settles on a floor; one corner is pulled.
Scene cloth_on_floor() {
  SceneBuilder builder("cloth on floor", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = test::cloth_spec(4, 0.012, 0.02);
  cloth.mesh.vertices.row(2) += 0.01 * cloth.mesh.vertices.row(0);
  cloth.material.bending = 1e-3;
  cloth.material.limit = StrainLimitSpec::from_limit(0.1);
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

test::RunEnd run(const Scene& scene, const std::string& shape, int steps, const MakeExecutor& make) {
  Method method = test::fixed_method(shape, 20);
  test::use_resident_solver(method);
  method.make_potential = test::on_executor(make);
  return test::run_steps(scene, std::move(method), steps);
}

void expect_same_on_all(const Scene& scene, const std::string& shape, int steps) {
  const test::RunEnd host = run(scene, shape, steps, [] { return std::make_unique<exec::HostExecutor>(); });
  EXPECT_EQ(host.status, std::vector<StepStatus>(host.status.size(), StepStatus::converged));
  EXPECT_GT(*std::max_element(host.iterations.begin(), host.iterations.end()), 1);
  ASSERT_GT(host.contacts, 0u);
  ASSERT_GT((host.x - scene.x0).cwiseAbs().maxCoeff(), 1e-3);
  const MakeExecutor others[] = {[] { return std::make_unique<ptx::PtxExecutor>(); },
                                 [] { return std::make_unique<cuda::DeviceExecutor>(); }};
  for (const MakeExecutor& make : others) {
    SCOPED_TRACE(std::string(make()->name()));
    const test::RunEnd there = run(scene, shape, steps, make);
    EXPECT_EQ(there.status, host.status) << standin::counts().fault;
    EXPECT_EQ(there.iterations, host.iterations);
    EXPECT_EQ(there.contacts, host.contacts);
    EXPECT_EQ(there.x, host.x);
  }
}

class StandinSystem : public testing::TestWithParam<const char*> {};

TEST_P(StandinSystem, StepsWithTheBitsOfTheHost) {
  standin::reset();
  expect_same_on_all(cloth_on_floor(), GetParam(), 4);
  expect_same_on_all(test::touching(test::two_sheets(), 0.01), GetParam(), 2);
  EXPECT_GT(standin::counts().launches, 1000);
  EXPECT_GT(standin::counts().replays, 1);
  EXPECT_EQ(standin::counts().in_use, 0u);
}

INSTANTIATE_TEST_SUITE_P(Shapes, StandinSystem, testing::Values("cubic", "quadratic"));

}  // namespace
}  // namespace bb
