// What an iteration and a step report of their contacts, over rows of both tables.
#include <gtest/gtest.h>

#include <vector>

#include "core/newton/iteration.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::iteration_report_test {
namespace {

constexpr double d_hat = 0.01, kappa = 5;

/// Two free rods that cross at the height of `gap` at an angle of 0.04: nearly parallel, one mollified row.
/// And a free particle at `particle_gap` over the middle of a plate, where six triangles meet: one row.
Scene rods_and_particle(double gap, double particle_gap) {
  Scene scene;
  test::add_body(scene, "rod", {Vec3d(-0.5, 0, 5), Vec3d(0.5, 0, 5)}, {}, d_hat);
  test::add_body(scene, "other", {Vec3d(-0.5, -0.01, 5 + gap), Vec3d(0.5, 0.01, 5 + gap)}, {}, d_hat);
  scene.surface_edges = {{0, 1}, {2, 3}};
  const auto [vertices, triangles] = test::grid(2, 2, 1.0);
  test::add_body(scene, "plate", vertices, triangles, 2 * d_hat, true);
  test::add_body(scene, "particle", {Vec3d(1, 1, particle_gap)}, {}, 2 * d_hat);
  return scene;
}

class Watch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override { reports.push_back(report); }
  std::vector<IterationReport> reports;
};

TEST(IterationReport, the_smallest_gap_is_that_of_a_mollified_row_where_it_is_the_closest) {
  struct Case {
    double gap, particle_gap, smallest, relative;
  };
  // the particle's d_hat is twice the rods': the smallest gap and the smallest relative gap may be two rows'
  for (const Case& c :
       {Case{0.002, 0.018, 0.002, 0.2}, Case{0.008, 0.004, 0.004, 0.2}, Case{0.004, 0.006, 0.004, 0.3}}) {
    const Scene scene = rods_and_particle(c.gap, c.particle_gap);
    Method method = test::fixed_method("cubic", kappa);
    Simulation simulation(scene, method, 1e-3, 1);
    Watch watch;
    simulation.step(watch);
    const IterationReport& first = watch.reports.at(0);
    ASSERT_EQ(first.contacts.mollified, 1U);
    ASSERT_EQ(first.contacts.point_point, 6U);  // pairs of one feature
    EXPECT_NEAR(first.gap_min_iterates_m.value, c.smallest, 1e-12);
    EXPECT_NEAR(first.gap_min_iterates_rel.value, c.relative, 1e-9);
    EXPECT_EQ(first.kappa_min_N_per_m.value, kappa);
    EXPECT_EQ(first.kappa_max_N_per_m.value, kappa);
  }
}

TEST(IterationReport, a_load_and_a_curvature_are_those_of_one_pair) {
  const double depth = 0.012;  // of 0.02
  const Scene scene = rods_and_particle(0.9 * d_hat, 2 * d_hat - depth);
  Method method = test::fixed_method("cubic", kappa);
  Simulation simulation(scene, method, 1e-3, 1);
  Watch watch;
  simulation.step(watch);
  const IterationReport& first = watch.reports.at(0);
  ASSERT_EQ(first.contacts.total(), 7U);
  EXPECT_NEAR(first.contact_load_max_N.value, kappa * 2 / (2 * d_hat) * depth * depth, 1e-9);
  StepReport at_start;
  NewtonSystem system(scene, method);
  Prediction at_rest;
  at_rest.x_tilde = scene.x0;
  system.begin_step(scene.x0, at_rest, 1e-3, 1.0);
  system.assemble();
  measure_end(system, at_start);
  EXPECT_EQ(at_start.contact_load_max_N.value, first.contact_load_max_N.value);
  EXPECT_EQ(at_start.contacts.total(), 7U);
  EXPECT_EQ(at_start.gap_min_m.value, first.gap_min_iterates_m.value);
  EXPECT_NEAR(first.contact_curvature_max_N_per_m.value, kappa * 4 / (2 * d_hat) * depth, 1e-6);
}

}  // namespace
}  // namespace bb::iteration_report_test
