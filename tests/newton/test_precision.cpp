// The pipeline in double, mixed and float: what differs in a step, and what does not.
#include <gtest/gtest.h>

#include "core/newton/iteration.hpp"
#include "tests/newton/buckling_step.hpp"

namespace bb::test::precision_test {
namespace {

Method method_in(Precision precision) {
  Method method = method_with(StepHessian::blend);
  method.precision = precision;
  method.contact.in_float = method.limit.in_float = values_in_float(precision);
  return method;
}

bool all_floats(const Positions& x) { return x.cast<float>().cast<double>() == x; }

TEST(Precision, mixed_comes_to_the_state_of_double) {
  const OneStep full(method_in(Precision::full), 0.99), mixed(method_in(Precision::mixed), 0.99);
  ASSERT_GT(full.watch.contacts, 10U);
  ASSERT_GT(mixed.watch.contacts, 10U);
  ASSERT_EQ(full.report.status, StepStatus::converged);
  ASSERT_EQ(mixed.report.status, StepStatus::converged);
  EXPECT_LT((full.x() - mixed.x()).cwiseAbs().maxCoeff(), 4 * tolerance);
  EXPECT_NE(full.x(), mixed.x());  // on another way
  EXPECT_FALSE(all_floats(mixed.x()));
}

TEST(Precision, every_state_of_a_float_run_is_a_float) {
  class States final : public StepObserver {
   public:
    void on_motion(const Positions& x0, const Positions& x1, int) override {
      ++motions;
      floats += all_floats(x0) && all_floats(x1) ? 1 : 0;
    }
    int motions = 0, floats = 0;
  } states;
  const Scene scene = buckling_cloth(0.99);
  Method method = method_in(Precision::single);
  method.step_solver.max_iterations = 40;
  Simulation simulation(scene, method, dt, 1);
  simulation.step(states);
  EXPECT_GT(states.motions, 2);
  EXPECT_EQ(states.floats, states.motions);
  EXPECT_GT(contact_state(simulation.system().diagnosis().terms()).size(), 10U);
  EXPECT_TRUE(all_floats(simulation.history().x));
}

TEST(Precision, a_float_step_ends_near_that_of_double_where_it_converges) {
  Scene scene = particle_over_plane(0.2, 0.008, 0.01);
  const auto end = [&](Precision precision) {
    Method method = fixed_method("log", 30);
    method.precision = precision;
    method.contact.in_float = values_in_float(precision);
    Simulation simulation(scene, method, 0.01, 1);
    StepObserver nobody;
    const StepReport report = simulation.step(nobody);
    EXPECT_EQ(report.status, StepStatus::converged);
    EXPECT_EQ(report.contacts.obstacle, 1U);
    return simulation.history().x(2, 0);
  };
  const double full = end(Precision::full), single = end(Precision::single);
  EXPECT_NE(full, single);
  EXPECT_NEAR(full, single, 1e-7);
}

TEST(Precision, far_from_the_origin_a_gap_of_few_ulps_stops_a_float_step_and_no_double_one) {
  const double far = 1000;  // m; an ulp of float there is 6e-5 m
  Scene scene = particle_over_plane(0.2, 6e-3, 4e-3);
  scene.v0(2, 0) = -1;
  scene.x0.row(2).array() += far;
  scene.obstacles[0].point[2] = far;
  struct End {
    StepStatus status;
    double gap;  // m
  };
  const auto run = [&](Precision precision) {
    Method method = fixed_method("log", 30);
    method.precision = precision;
    method.contact.in_float = values_in_float(precision);
    Simulation simulation(scene, method, 0.01, 1);
    StepObserver nobody;
    const StepStatus status = simulation.step(nobody).status;
    return End{status, contact_state(simulation.system().diagnosis().terms()).gap_min};
  };
  const End full = run(Precision::full), single = run(Precision::single);
  EXPECT_EQ(full.status, StepStatus::converged);
  EXPECT_LT(full.gap, 1e-4);
  EXPECT_EQ(single.status, StepStatus::step_collapse);
  const double floor = 16 * std::numeric_limits<float>::epsilon() * far;  // below it ACCD proves nothing
  EXPECT_GT(single.gap, 0.5 * floor);
  EXPECT_LT(single.gap, 1.1 * floor);
}

TEST(Precision, a_change_of_the_energy_is_judged_by_the_rounding_of_the_precision) {
  const EnergyChange change{1e-6, 1};
  EXPECT_FALSE(within_rounding(change));
  EXPECT_FALSE(within_rounding(change, Precision::mixed));
  EXPECT_TRUE(within_rounding(change, Precision::single));
}

}  // namespace
}  // namespace bb::test::precision_test
