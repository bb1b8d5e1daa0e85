// Where the time of a step goes, and what is not computed because it is known: structure, no speed.
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>

#include "core/terms/strain_limit.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::times_test {
namespace {

/// Two limited cloths, the upper one falling onto the lower, which falls onto a floor; a corner is held.
Scene falling_cloths() {
  SceneBuilder builder("cloths", false, Vec3d(0, 0, -10), "test");
  for (const double height : {0.009, 0.018}) {
    BodySpec spec = test::cloth_spec(5, height, 0.01);
    spec.name = height < 0.01 ? "lower" : "upper";
    spec.material.bending = 1e-4;
    spec.material.limit = StrainLimitSpec{0.025, 0.025};
    PinSpec corner;
    corner.indices = {0};
    if (height < 0.01) spec.pins = {corner};
    builder.add_body(spec);
  }
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

Method limited_method() {
  Method method = test::fixed_method("cubic", 200);
  method.limit_stiffness = test::elastic_limit({.refresh = Refresh::per_step});
  return method;
}

struct Watch final : StepObserver {
  PhaseTimes iterations;
  double on_step_s = 0;
  long long trials = 0;
  void on_iteration(const IterationReport& report) override {
    iterations += report.time;
    trials += report.line_search_trials;
  }
  void on_step(StepSystem&, const StepReport&, const Positions&) override {
    const double start = now_s();
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    on_step_s += now_s() - start;
  }
};

TEST(Times, every_moment_of_a_step_belongs_to_a_phase) {
  const Scene scene = falling_cloths();
  Method method = limited_method();
  Simulation simulation(scene, method, 0.005, 4);
  PhaseTimes sum;
  double wall = 0;
  Watch watch;
  std::size_t contacts = 0;
  for (int i = 0; i < 4; ++i) {
    const double start = now_s();
    const StepReport report = simulation.step(watch);
    wall += now_s() - start;
    ASSERT_EQ(report.status, StepStatus::converged);
    contacts = std::max(contacts, report.contacts.total());
    sum += report.time;
  }
  ASSERT_GT(contacts, 10U);
  for (std::size_t phase = 0; phase < kPhases; ++phase) EXPECT_GT(sum.s[phase], 0) << kPhaseNames[phase];
  EXPECT_LE(sum.total_s(), wall);
  EXPECT_LT(wall - sum.total_s(), 0.02 * wall);  // two calls of the clock a step
  EXPECT_GE(sum[Phase::output], watch.on_step_s);
  EXPECT_LE(watch.iterations.solve_s(), sum.solve_s());
  EXPECT_GT(watch.iterations[Phase::strain_limit], 0);
}

TEST(Times, a_state_of_the_limit_is_measured_once) {
  SceneBuilder builder("hung cloth", false, Vec3d(0, -10, 0), "test");
  BodySpec spec = test::cloth_spec(5, 0, 0.001);
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  PinSpec top;
  top.box = {Vec3d(-10, 0.49, -1), Vec3d(10, 10, 1)};
  spec.pins = {top};
  builder.add_body(spec);
  const Scene scene = builder.finish();
  Method method = limited_method();
  Simulation simulation(scene, method, 0.01, 1);
  Watch watch;
  const StepReport report = simulation.step(watch);
  ASSERT_EQ(report.status, StepStatus::converged);
  ASSERT_GT(report.max_stretch.value, 0);
  ASSERT_GE(report.newton_iterations, 2);
  // the start and every trial; accepted trials, their derivatives and the reports reuse what is known
  EXPECT_EQ(simulation.system().diagnosis().terms().find<StrainLimitTerm>()->family().sweeps(),
            1 + watch.trials);
}

}  // namespace
}  // namespace bb::times_test
