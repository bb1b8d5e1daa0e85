// Steps that curved gaps hold: a second-order correction lets them through.
#include <gtest/gtest.h>

#include "tests/newton/curved_gaps.hpp"

namespace bb::curvature_correction_test {
namespace {

struct Log final : StepObserver {
  std::vector<IterationReport> iterations;
  void on_iteration(const IterationReport& report) override { iterations.push_back(report); }
};

struct Steps {
  int iterations = 0;
  double gap = 0, load = 0;  // of the last step
  Log log;
};

Steps take_steps(double load, int n_steps = 4) {
  const Scene scene = test::strip_on_disk();
  Method method = test::soft_method(load);
  Simulation simulation(scene, method, test::rolling_dt, n_steps);
  Steps out;
  for (int i = 0; i < n_steps; ++i) {
    const StepReport step = simulation.step(out.log);
    EXPECT_EQ(step.status, StepStatus::converged) << "load " << load << ", step " << i << ": " << step.detail;
    out.iterations += step.newton_iterations;
    out.gap = step.gap_min_m.value;
    out.load = step.contact_load_max_N.value;
  }
  return out;
}

// The strip presses with some tenths of N. Without the correction a load of 1e-3 N takes 123 iterations, and with one of
// 1e-6 N three of the four steps do not end: gaps are pressed to 1e-14 m.
TEST(CurvatureCorrection, a_soft_barrier_costs_few_iterations_more_than_a_stiff_one) {
  const Steps stiff = take_steps(0.1);
  EXPECT_LT(stiff.iterations, 40);
  double gap = stiff.gap;
  for (const double load : {1e-3, 1e-6}) {
    const Steps soft = take_steps(load);
    EXPECT_LT(soft.iterations, load < 1e-4 ? 120 : 60) << load;
    EXPECT_LT(soft.gap, gap / 10);
    EXPECT_NEAR(soft.load / stiff.load, 1, 0.3);  // the barrier does not decide what it carries
    gap = soft.gap;
    int detours = 0;
    double least = 1;
    for (const IterationReport& i : soft.log.iterations) {
      detours += static_cast<int>(i.detours);
      if (i.contacts.total() > 0) least = std::min(least, i.gap_min_iterates_m.value);
    }
    EXPECT_GT(detours, 0);
    EXPECT_GT(least, soft.gap / 1000);  // no iterate is pressed far below the gap that carries the load
  }
}

TEST(CurvatureCorrection, counts_its_solve_and_its_queries_and_is_no_whole_direction) {
  int seen = 0, whole = 0;
  for (const double load : {1e-2, 1e-3, 1e-5}) {
    const std::vector<IterationReport> all = take_steps(load).log.iterations;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      const IterationReport &now = all[i], &after = all[i + 1];
      EXPECT_EQ(now.linear_solves, 1 + now.hessian_fallbacks + now.solve.corrections);
      EXPECT_GE(now.solve.corrections, now.detours);
      if (now.detours == 0) continue;
      ++seen;
      whole += now.alpha == 1 && after.iteration > 0;
      EXPECT_LE(now.alpha, now.alpha_ccd);
      EXPECT_LT(now.energy_change_J.value, 0);
      EXPECT_FALSE(after.contraction.finite()) << load << " " << now.iteration;
    }
  }
  EXPECT_GT(seen, 3);
  EXPECT_GT(whole, 0);
}

// Where no gap is curved along the direction nothing is solved twice: a point over a plane, from above and from below.
TEST(CurvatureCorrection, is_not_made_where_gaps_are_straight) {
  Scene scene = test::particle_over_plane(0.1, 0.05, 0.01);
  scene.v0.col(0) = Vec3d(0, 0, -20);
  Method method = test::fixed_method("log", 1e-3);
  Simulation simulation(scene, method, 0.01, 1);
  Log log;
  ASSERT_EQ(simulation.step(log).status, StepStatus::converged);
  int held = 0;
  for (const IterationReport& i : log.iterations) {
    held += i.alpha_ccd < 1;
    EXPECT_EQ(i.solve.corrections, 0);
  }
  EXPECT_GT(held, 3);
}

}  // namespace
}  // namespace bb::curvature_correction_test
