// What a policy that adapts between steps is told: the pair that closes, its gap at this step end and the
// last.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/newton/small_scenes.hpp"

namespace bb {
namespace {

class Listening final : public StiffnessPolicy {
 public:
  explicit Listening(std::vector<StepEnd>& heard) : heard_(heard) {}
  std::string_view name() const override { return "listening"; }
  Refresh refresh() const override { return Refresh::per_step; }
  void fill(const StiffnessBatch& rows, double* kappa) const override { std::fill_n(kappa, rows.n, 400.0); }
  void end_step(const StepEnd& end) override { heard_.push_back(end); }

 private:
  std::vector<StepEnd>& heard_;
};

TEST(StepEnd, names_a_gap_while_it_shrinks_and_nothing_while_it_opens) {
  constexpr double d_hat = 0.01;
  Scene scene = test::particle_over_plane(0.2, 0.95 * d_hat, d_hat);
  scene.v0.col(0) = Vec3d(0, 0, -0.4);
  std::vector<StiffnessPolicy::StepEnd> heard;
  Method method = test::fixed_method("log", 1);
  method.stiffness = std::make_unique<Listening>(heard);
  constexpr int steps = 20;
  Simulation simulation(scene, method, 0.002, steps);
  StepObserver observer;
  std::vector<double> gap;
  for (int i = 0; i < steps; ++i) gap.push_back(simulation.step(observer).gap_min);

  ASSERT_EQ(heard.size(), gap.size());
  EXPECT_TRUE(std::isinf(heard[0].min_gap));  // no step before
  int closing = 0, opening = 0;
  for (std::size_t i = 1; i < gap.size(); ++i) {
    if (!(gap[i] < d_hat && gap[i - 1] < d_hat)) continue;
    if (gap[i] < gap[i - 1]) {
      EXPECT_EQ(heard[i].min_gap, gap[i]);
      EXPECT_EQ(heard[i].min_gap_prev, gap[i - 1]);
      EXPECT_EQ(heard[i].park, method.contact_options.ccd_park * d_hat);
      ++closing;
    } else {
      EXPECT_TRUE(std::isinf(heard[i].min_gap));
      ++opening;
    }
  }
  EXPECT_GT(closing, 2);
  EXPECT_GE(opening, 2);
}

/// Two particles close; the one that was nearer the plane is the reason, whatever its order in the table.
TEST(StepEnd, takes_the_pair_that_was_closest) {
  constexpr double d_hat = 0.01;
  Scene scene = test::particle_over_plane(0.2, 0.9 * d_hat, d_hat);
  scene.bodies = {{"particles", 0, 2}};
  Positions two(3, 2);
  two << 0, 1, 0, 0, 0.9 * d_hat, 0.8 * d_hat;
  scene.rest = scene.x0 = two;
  scene.v0 = Positions::Zero(3, 2);
  scene.v0.row(2).setConstant(-0.3);
  scene.mass = {0.2, 0.2};
  scene.body = {0, 0};
  scene.d_hat = {d_hat, d_hat};
  scene.offset = {0, 0};
  scene.surface_vertices = {0, 1};
  std::vector<StiffnessPolicy::StepEnd> heard;
  Method method = test::fixed_method("log", 1);
  method.stiffness = std::make_unique<Listening>(heard);
  Simulation simulation(scene, method, 0.002, 2);
  StepObserver observer;
  simulation.step(observer);
  const double before = simulation.history().x(2, 1);
  simulation.step(observer);
  EXPECT_LT(simulation.history().x(2, 1), before);
  EXPECT_EQ(heard[1].min_gap_prev, before);
  EXPECT_EQ(heard[1].min_gap, simulation.history().x(2, 1));
}

}  // namespace
}  // namespace bb
