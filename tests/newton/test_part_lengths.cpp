// A run in parts of unlike length: the integrator receives the length that each step really had.
#include <gtest/gtest.h>

#include <vector>

#include "tests/newton/thrown_particle.hpp"

namespace bb::part_lengths_test {
namespace {

constexpr double dt = 0.01;

using test::thrown_particle;

Method method_of(const std::string& integrator) { return test::fixed_method("cubic", 2000, integrator); }

/// Iterations of the whole first step.
int needed(const std::string& integrator) {
  const Scene scene = thrown_particle();
  Method method = method_of(integrator);
  Simulation simulation(scene, method, dt, 1);
  StepObserver nobody;
  const StepReport step = simulation.step(nobody);
  EXPECT_EQ(step.status, StepStatus::converged);
  EXPECT_EQ(step.contacts.obstacle, 1U);
  return step.newton_iterations;
}

/// The states of a run kept as an integrator reads them, each with the length of the step that the report names.
struct Kept {
  History history;
  Prediction prediction;
  Positions v;

  explicit Kept(const Scene& scene) {
    history.x = history.x_prev = scene.x0;
    history.v = history.v_prev = v = scene.v0;
    history.a = Positions::Zero(3, scene.x0.cols());
  }
  /// The velocity at the end of a step that reached x.
  const Positions& finish(const Integrator& integrator, double length, const Positions& x) {
    integrator.predict(history, length, prediction);
    integrator.finish(history, length, prediction, x, v, history.a);
    history.x_prev = history.x, history.x = x;
    history.v_prev = history.v, history.v = v;
    history.dt_prev = length;
    ++history.steps;
    return v;
  }
};

/// Of bdf2, which reads the length of the step before: two parts of one length have its coefficients, a part behind one
/// of another length starts anew.
TEST(PartLengths, VelocitiesAreThoseOfTheStepsThatWereDone) {
  const Scene scene = thrown_particle();
  const int cap = needed("bdf2") - 1;
  Method method = method_of("bdf2");
  method.step_solver.max_iterations = cap;
  method.step_solver.retries = 6;
  Simulation simulation(scene, method, dt, 8);
  StepObserver nobody;
  Kept kept(scene);
  int changes = 0, halves_in_a_row = 0, retries = 0;
  double before = 0;
  while (simulation.nominal_steps() < 8) {
    const StepReport step = simulation.step(nobody);
    ASSERT_EQ(step.status, StepStatus::converged) << step.detail;
    const Positions& v = kept.finish(*method.integrator, step.dt_s, simulation.history().x);
    EXPECT_EQ(simulation.history().v, v) << "step " << step.step << " of " << step.dt_s << " s";
    retries += step.retries;
    changes += before > 0 && step.dt_s != before;
    halves_in_a_row += step.dt_s == before && step.dt_s < dt;
    before = step.dt_s;
  }
  EXPECT_GT(retries, 0);
  EXPECT_GT(changes, 0);
  EXPECT_GT(halves_in_a_row, 0);
  EXPECT_EQ(before, dt);  // back to whole steps
}

/// By implicit Euler, along the floor, where nothing acts: each part moves the particle by its own length times the speed.
TEST(PartLengths, OfAnAttemptThatFailedIsNothingLeft) {
  const Scene scene = thrown_particle();
  const int cap = needed("implicit_euler") - 1;
  Method method = method_of("implicit_euler");
  method.step_solver.max_iterations = cap;
  method.step_solver.retries = 6;
  Simulation simulation(scene, method, dt, 4);
  StepObserver nobody;
  double time = 0, x = scene.x0(0, 0);
  int shorter = 0;
  while (simulation.nominal_steps() < 4) {
    const StepReport step = simulation.step(nobody);
    ASSERT_EQ(step.status, StepStatus::converged) << step.detail;
    time += step.dt_s;
    EXPECT_NEAR(simulation.time(), time, 1e-15);
    EXPECT_NEAR(simulation.history().x(0, 0), x + 0.4 * step.dt_s, 1e-14);  // nothing acts along the floor
    x = simulation.history().x(0, 0);
    shorter += step.dt_s < dt;
  }
  EXPECT_GT(shorter, 1);
  EXPECT_NEAR(x, 0.4 * 4 * dt, 1e-12);
}

}  // namespace
}  // namespace bb::part_lengths_test
