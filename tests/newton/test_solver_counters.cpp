// Counters that step solvers declare: who fills them, and what several steps, or attempts at one, make of them.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::solver_counters_test {
namespace {

constexpr double dt = 0.01;

StepReport step_of(const std::string& solver, const Scene& scene, int retries = 0, int most = 200) {
  Method method = test::fixed_method("cubic", 2000);
  choose_step_solver(method, solver);
  method.step_solver.retries = retries;
  method.step_solver.max_iterations = most;
  method.step_solver.saddle = SaddleRule::ignore;
  fit_terms(method);
  Simulation simulation(scene, method, dt, 1);
  StepObserver none;
  return simulation.step(none);
}

TEST(SolverCounters, EveryStepHasThoseOfItsSolverAndNoOthers) {
  const Scene scene = test::particle_over_plane(0.2, 0.012, 0.01);
  std::size_t all = 0;
  for (const StepSolverEntry& entry : step_solvers()) {
    std::set<std::string> declared, found;
    for (const SolverCounter& counter : entry.counters) {
      declared.insert(counter.name);
      EXPECT_EQ(counter.doc.rfind(entry.name + ": ", 0), 0U) << counter.doc;
    }
    for (const auto& [name, value] : step_of(entry.name, scene).solver.values) found.insert(name);
    EXPECT_EQ(found, declared) << entry.name;
    all += found.size();
  }
  EXPECT_EQ(step_solver_counters().size(), all);
  EXPECT_GE(all, 6U);
}

/// A free fall is one whole direction, and one iteration after it.
TEST(SolverCounters, OfAccumulatedToiAreItsTimeAndTheIterationsBeforeTheLast) {
  const StepReport step = step_of("accumulated_toi", test::particle_over_plane(0.2, 100, 0.01));
  ASSERT_EQ(step.status, StepStatus::converged);
  EXPECT_EQ(step.solver.values.at("toi"), 1);
  EXPECT_EQ(step.solver.values.at("toi_iterations"), step.newton_iterations - 1);
}

TEST(SolverCounters, SumsAreOfAllAttemptsAndTheRestIsOfTheLast) {
  const std::vector<SolverCounter> counters = {
      {"a", "", OverSteps::sum}, {"b", "", OverSteps::largest}, {"c", "", OverSteps::smallest}};
  StepReport failed, last;
  failed.solver.values = {{"a", 2}, {"b", 5}, {"c", 1}};
  last.solver.values = {{"a", 3}, {"b", 4}, {"c", 7}};
  last.add_attempt(failed, counters);
  EXPECT_EQ(last.solver.values, (std::map<std::string, double>{{"a", 5}, {"b", 4}, {"c", 7}}));

  Scene scene = test::particle_over_plane(0.2, 0.012, 0.01);
  scene.v0(2, 0) = -30;  // free for less than a quarter of each of three lengths
  const StepReport step = step_of("accumulated_toi", scene, 2, 1);
  ASSERT_EQ(step.retries, 2);
  EXPECT_EQ(step.solver.values.at("toi_iterations"), step.newton_iterations);
  EXPECT_EQ(step.newton_iterations, 3);
}

TEST(SolverCounters, OverStepsAreSumLargestOrSmallest) {
  const std::vector<SolverCounter> counters = {
      {"a", "", OverSteps::sum}, {"b", "", OverSteps::largest}, {"c", "", OverSteps::smallest}};
  SolverCounts run;
  for (const double of_step : {3.0, 1.0, 2.0})
    run.add(counters, {{{"a", of_step}, {"b", of_step}, {"c", of_step}}});
  EXPECT_EQ(run.values, (std::map<std::string, double>{{"a", 6}, {"b", 3}, {"c", 1}}));
}

/// A rod whose end is driven: until it is at its pose feasibility alone judges its trials.
TEST(SolverCounters, OfLineSearchAreTrialsShortOfAPose) {
  SceneBuilder builder("driven", false, Vec3d::Zero(), "test");
  BodySpec spec = test::cloth_spec(4, 0.02, 0.01);
  PinSpec pin;
  pin.indices = {0, 3, 12, 15};
  pin.motion.velocity = Vec3d(0, 0, 0.5);
  spec.pins = {pin};
  builder.add_body(spec);
  const StepReport driven = step_of("line_search", builder.finish());
  ASSERT_EQ(driven.status, StepStatus::converged);
  EXPECT_GE(driven.solver.values.at("feasibility_trials"), 1);
  EXPECT_LT(driven.solver.values.at("feasibility_trials"), static_cast<double>(driven.line_search_trials));
  EXPECT_EQ(
      step_of("line_search", test::particle_over_plane(0.2, 1, 0.01)).solver.values.at("feasibility_trials"),
      0);
}

}  // namespace
}  // namespace bb::solver_counters_test
