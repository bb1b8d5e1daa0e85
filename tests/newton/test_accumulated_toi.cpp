// The accumulated-time step: how far it gets, when it stops, what its last pass belongs to.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/saddle_scenes.hpp"

namespace bb::accumulated_toi_test {
namespace {

constexpr double dt = 0.01, gravity = 10;

class Watch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override { reports.push_back(report); }
  std::vector<IterationReport> reports;
};

struct Flight {
  StepReport report;
  Watch watch;
  double time, z, v;
};

/// Speed at which the largest motion of one iteration, 1 m, is that share of a free step.
double speed_for(double share) { return (1 / share - dt * dt * gravity) / dt; }

constexpr double height = 100;  // m, of the particle at the start

/// One step of a particle that falls freely.
Flight fly(const StepSolverOptions& options, double speed, const std::vector<GravityKey>& keys = {}) {
  Scene scene = test::particle_over_plane(0.2, height, 0.001);
  scene.gravity_keys = keys;
  scene.v0(2, 0) = -speed;
  Method method = test::fixed_method("cubic", 1);
  const double tolerance = method.step_solver.tol_velocity;
  method.step_solver = options;
  choose_step_solver(method, "accumulated_toi");
  method.step_solver.tol_velocity = tolerance;
  method.step_solver.parameters["max_dx_m"] = 1.0;
  Simulation simulation(scene, method, dt, 1);
  Flight out;
  out.report = simulation.step(out.watch);
  out.time = simulation.time();
  out.z = simulation.history().x(2, 0);
  out.v = simulation.history().v(2, 0);
  return out;
}

/// Implicit Euler over a step of length h.
double fallen(double h, double speed) { return h * speed + h * h * gravity; }

TEST(AccumulatedToi, a_step_shortened_by_its_largest_motion_ends_where_its_own_time_says) {
  StepSolverOptions options;
  options.parameters["target_toi"] = 0.25;
  const double speed = speed_for(0.4);
  const Flight flight = fly(options, speed);
  ASSERT_EQ(flight.report.status, StepStatus::converged);
  EXPECT_EQ(flight.report.newton_iterations, 2);
  EXPECT_NEAR(flight.watch.reports[0].alpha, 0.4, 1e-12);
  EXPECT_NEAR(flight.report.dt_s, 0.4 * dt, 1e-12);
  EXPECT_NEAR(flight.time, 0.4 * dt, 1e-12);
  EXPECT_NEAR(height - flight.z, fallen(0.4 * dt, speed), 1e-12);
  EXPECT_NEAR(-flight.v, speed + gravity * 0.4 * dt, 1e-9);
}

TEST(AccumulatedToi, a_shortened_step_has_the_gravity_of_its_own_end) {
  StepSolverOptions options;
  options.parameters["target_toi"] = 0.25;
  const double speed = speed_for(0.4);
  const Flight flight = fly(options, speed, {{0, Vec3d::Zero()}, {dt, Vec3d(0, 0, -gravity)}});
  ASSERT_EQ(flight.report.status, StepStatus::converged);
  const double h = flight.report.dt_s;
  ASSERT_NEAR(h / dt, 0.4, 0.01);
  EXPECT_NEAR(height - flight.z, h * speed + h * h * gravity * (h / dt), 1e-12);
  ASSERT_GT(h * h * gravity * (1 - h / dt), 1e-5) << "what the gravity of the whole step would add";
}

TEST(AccumulatedToi, parts_accumulate_as_shares_of_what_is_left) {
  StepSolverOptions options;
  const double target = 0.9, speed = speed_for(0.4);
  options.parameters["target_toi"] = target;
  const Flight flight = fly(options, speed);
  // 0.4 of the motion twice, then the rest, which is shorter than 1 m: 0.4 + 0.6 * 2/3 + 0.2 * 1
  ASSERT_EQ(flight.report.status, StepStatus::converged);
  double beta = 0;
  std::size_t used = 0;
  for (; used < flight.watch.reports.size() && beta < target; ++used) {
    beta += (1 - beta) * flight.watch.reports[used].alpha;
  }
  EXPECT_EQ(used, 3U);
  EXPECT_EQ(flight.report.newton_iterations, 4);  // and the pass that reduces the error
  EXPECT_NEAR(flight.report.dt_s, beta * dt, 1e-15);
  EXPECT_NEAR(beta, 1, 1e-12);
  EXPECT_NEAR(height - flight.z, fallen(dt, speed), 1e-12);
}

TEST(AccumulatedToi, makes_at_least_the_iterations_that_are_asked_for) {
  for (const int least : {1, 2, 4}) {
    StepSolverOptions options;
    options.parameters["min_newton_steps"] = least;
    const Flight flight = fly(options, 1);
    EXPECT_EQ(flight.report.newton_iterations, least + 1);
    EXPECT_NEAR(flight.report.dt_s, dt, 1e-15);
  }
}

TEST(AccumulatedToi, a_step_that_runs_out_of_iterations_keeps_the_time_it_reached) {
  StepSolverOptions options;
  options.parameters["target_toi"] = 0.9;
  options.max_iterations = 2;
  const Flight flight = fly(options, speed_for(0.1));
  EXPECT_EQ(flight.report.status, StepStatus::iteration_cap);
  const double first = 0.1, second = 0.1 / 0.9;
  EXPECT_NEAR(flight.report.dt_s, (first + (1 - first) * second) * dt, 1e-12);
}

/// A free step is Newton's, not `extension` times it; a bound one keeps that distance from the floor.
TEST(AccumulatedToi, the_extension_is_room_that_is_kept_and_not_way_that_is_gone) {
  StepSolverOptions options;
  const Flight free = fly(options, 1);
  EXPECT_EQ(free.watch.reports[0].alpha, 1);
  EXPECT_NEAR(height - free.z, fallen(dt, 1), 1e-12);

  Scene scene = test::particle_over_plane(0.2, 0.02, 0.001);
  scene.v0(2, 0) = -10;
  Method method = test::fixed_method("cubic", 1);
  choose_step_solver(method, "accumulated_toi");
  method.step_solver.max_iterations = 1;
  Simulation simulation(scene, method, dt, 1);
  Watch watch;
  simulation.step(watch);
  ASSERT_LT(watch.reports.at(0).alpha_ccd, 1);
  const double way = 0.02 / (0.1 + gravity * dt * dt) / 1.25;  // to the floor, of 1.25 times
  EXPECT_NEAR(watch.reports[0].alpha, way, 1e-3 * way);
  EXPECT_NEAR(scene.x0(2, 0) - simulation.history().x(2, 0), 0.02 / 1.25, 1e-4);
}

Method sheet_method(SaddleRule rule) {
  Method method = test::saddle_method(rule);
  choose_step_solver(method, "accumulated_toi");
  return method;
}

StepReport converged_step(Simulation& simulation) {
  Watch watch;
  const StepReport report = simulation.step(watch);
  EXPECT_EQ(report.status, StepStatus::converged);
  return report;
}

/// Where a sheet that buckles over two planes got to: how far that is from a solution is measured from there, and to
/// measure changes nothing.
TEST(AccumulatedToi, says_how_far_its_end_is_from_the_solution) {
  const Scene scene = test::driven_sheet({.jitter = 1e-4});
  Method method = sheet_method(SaddleRule::ignore);
  Simulation simulation(scene, method, test::sheet_dt, 2);
  const StepReport report = converged_step(simulation);
  ASSERT_GT(report.contacts.total(), 0U);
  EXPECT_EQ(report.end_proof, EndProof::not_checked);
  ASSERT_TRUE(report.end_error_m.finite());
  EXPECT_GT(report.end_error_m.value, 1e-6);
  EXPECT_NEAR(report.end_error_tolerances.value,
              report.end_error_m.value / (report.dt_s * method.step_solver.tol_velocity), 1e-9);
  // the same direction from the same state, by hand
  NewtonSystem system(scene, method);
  Prediction prediction;
  History start;
  start.x = scene.x0, start.v = scene.v0;
  method.integrator->predict(start, report.dt_s, prediction);
  system.begin_step(scene.x0, prediction, report.dt_s, 1);
  system.assemble();
  const Positions& x = simulation.history().x;
  ASSERT_TRUE(test::try_state(system, x));
  system.accept();
  system.assemble();
  system.set_target(system.view().x());
  ASSERT_EQ(system.find_direction().linear.status, LinearStatus::ok);
  EXPECT_NEAR(system.direction_size().inf_m, report.end_error_m.value, 1e-6 * report.end_error_m.value);
}

TEST(AccumulatedToi, a_free_fall_ends_at_its_solution) {
  StepSolverOptions options;
  options.parameters["target_toi"] = 0.25;
  const Flight flight = fly(options, 1);
  EXPECT_LT(flight.report.end_error_tolerances.value, 1e-3);
}

/// report: the last matrix of a step that does not have to converge is looked at all the same.
TEST(AccumulatedToi, can_be_asked_whether_it_ends_in_a_saddle) {
  for (const double speed : {0.2, -0.2}) {
    const Scene scene = test::driven_sheet({.speed = speed});
    Method method = sheet_method(SaddleRule::report);
    Simulation simulation(scene, method, test::sheet_dt, 1);
    const StepReport report = converged_step(simulation);
    EXPECT_EQ(report.end_proof, speed > 0 ? EndProof::saddle : EndProof::factor);
  }
}

}  // namespace
}  // namespace bb::accumulated_toi_test
