// What decides in a step of accumulated_toi: what counts as the largest motion of an iteration, and to which length of
// the step its numbers belong.
#include <gtest/gtest.h>

#include <vector>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::accumulated_decisions_test {
namespace {

constexpr double dt = 0.01;

class Watch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override { reports.push_back(report); }
  std::vector<IterationReport> reports;
};

Method accumulated(double kappa = 1) {
  Method method = test::fixed_method("cubic", kappa);
  choose_step_solver(method, "accumulated_toi");
  method.step_solver.parameters["max_dx_m"] = 1.0;
  return method;
}

/// The part of its first direction that a particle takes which is to move by this, far from everything.
double part_taken(const Vec3d& motion) {
  Scene scene = test::particle_over_plane(0.2, 100, 0.001);
  scene.gravity.setZero();
  scene.v0.col(0) = motion / dt;
  Method method = accumulated();
  Simulation simulation(scene, method, dt, 1);
  Watch watch;
  const StepReport report = simulation.step(watch);
  EXPECT_EQ(report.status, StepStatus::converged);
  EXPECT_NEAR(report.dt_s, dt * watch.reports.at(0).alpha, 1e-12);
  EXPECT_LT((simulation.history().x - scene.x0 - watch.reports[0].alpha * motion).norm(), 1e-9);
  return watch.reports[0].alpha;
}

/// max_dx_m is the length of a vertex's way, whatever its direction.
TEST(AccumulatedDecisions, TheLargestMotionIsALengthInEveryDirection) {
  for (const Vec3d& way : {Vec3d(1, 0, 0), Vec3d(0, -1, 0), Vec3d(0, 0, 1), Vec3d(1, 1, 0), Vec3d(-1, 0, 1),
                           Vec3d(1, -1, 1), Vec3d(0.2, 0.9, -0.6)}) {
    const Vec3d unit = way.normalized();
    EXPECT_NEAR(part_taken(2.5 * unit), 0.4, 1e-9) << way.transpose();
    EXPECT_NEAR(part_taken(1.01 * unit), 1 / 1.01, 1e-9) << way.transpose();
    EXPECT_EQ(part_taken(0.99 * unit), 1) << way.transpose();
  }
}

/// A free vertex that stays, and one that is prescribed to move: the direction of both is cut.
TEST(AccumulatedDecisions, TheLargestMotionMayBeThatOfAPrescribedVertex) {
  for (const double length : {2.0, 0.99}) {
    Scene scene = test::particle_over_plane(0.2, 100, 0.001);
    scene.gravity.setZero();
    scene.bodies[0].n_vertices = 2;
    scene.x0.conservativeResize(3, 2);
    scene.x0.col(1) = Vec3d(50, 0, 100);
    scene.rest = scene.x0;
    scene.v0 = Positions::Zero(3, 2);
    scene.mass.push_back(0), scene.body.push_back(0), scene.d_hat.push_back(0.001), scene.offset.push_back(0);
    scene.motions.resize(1);
    scene.motions[0].velocity = Vec3d(1, 1, 1).normalized() * length / dt;
    scene.pins = {{1, 0}};
    Method method = accumulated();
    Simulation simulation(scene, method, dt, 1);
    Watch watch;
    ASSERT_EQ(simulation.step(watch).status, StepStatus::converged);
    EXPECT_NEAR(watch.reports.at(0).alpha, std::min(1.0, 1 / length), 1e-9);
    EXPECT_EQ(simulation.history().x.col(0), scene.x0.col(0));
  }
}

/// A particle that the floor stops after a part of its step: its numbers are those of a step of the length that was
/// reached.
TEST(AccumulatedDecisions, TheEndErrorIsInTolerancesOfTheLengthThatWasReached) {
  Scene scene = test::particle_over_plane(0.2, 0.02, 0.01);
  scene.v0(2, 0) = -4;
  Method method = accumulated(100);
  Simulation simulation(scene, method, dt, 1);
  Watch watch;
  const StepReport report = simulation.step(watch);
  ASSERT_EQ(report.status, StepStatus::converged);
  ASSERT_EQ(report.contacts.obstacle, 1U);
  ASSERT_LT(report.dt_s, 0.7 * dt);
  ASSERT_GT(report.dt_s, 0.2 * dt);
  ASSERT_GT(report.end_error_m.value, 1e-9);
  EXPECT_DOUBLE_EQ(report.end_error_tolerances.value,
                   report.end_error_m.value / (report.dt_s * method.step_solver.tol_velocity));
  EXPECT_DOUBLE_EQ(simulation.time(), report.dt_s);
  EXPECT_DOUBLE_EQ(simulation.history().v(2, 0), (simulation.history().x(2, 0) - 0.02) / report.dt_s);

  // Newton's direction at the end by hand: a step of that length from the start
  const double h = report.dt_s, z = simulation.history().x(2, 0), depth = 0.01 - z;
  const double force = -0.2 * (z - 0.02 + 4 * h) / (h * h) - 0.2 * 10 + 100 * 2 / 0.01 * depth * depth;
  const double stiffness = 0.2 / (h * h) + 100 * 4 / 0.01 * depth;
  EXPECT_NEAR(report.end_error_m.value, std::abs(force / stiffness), 1e-6 * report.end_error_m.value);
}

}  // namespace
}  // namespace bb::accumulated_decisions_test
