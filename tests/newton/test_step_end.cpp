// What a policy that adapts between steps is given: every pair with a row at two step ends in a row.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::step_end_test {
namespace {

constexpr double d_hat = 0.01, dt = 0.002;
using Heard = std::vector<std::vector<StiffnessPolicy::PairEnd>>;

class Listening final : public StiffnessPolicy {
 public:
  Listening(Heard& heard, bool adapts) : heard_(heard), adapts_(adapts) {}
  std::string_view name() const override { return "listening"; }
  Refresh refresh() const override { return Refresh::per_step; }
  void fill(const StiffnessBatch& rows, double* kappa) const override { std::fill_n(kappa, rows.n, 400.0); }
  bool adapts() const override { return adapts_; }
  void end_step(std::span<const PairEnd> pairs) override { heard_.emplace_back(pairs.begin(), pairs.end()); }

 private:
  Heard& heard_;
  bool adapts_;
};

/// Two particles that fall side by side onto a plane, the second with half the d_hat.
Scene two_particles() {
  Scene scene = test::particle_over_plane(0.2, 0.9 * d_hat, d_hat);
  scene.bodies = {{"particles", 0, 2}};
  scene.x0.resize(3, 2);
  scene.x0 << 0, 1, 0, 0, 0.9 * d_hat, 0.48 * d_hat;
  scene.rest = scene.x0;
  scene.v0 = Positions::Zero(3, 2);
  scene.v0.row(2).setConstant(-0.3);
  scene.mass = {0.2, 0.2};
  scene.body = {0, 0};
  scene.d_hat = {d_hat, d_hat / 2};
  scene.offset = {0, 0};
  scene.surface_vertices = {0, 1};
  return scene;
}

/// A run of the two particles whose policy keeps what it receives.
struct ListenedRun {
  Heard heard;
  Method method;
  Simulation simulation;
  StepObserver observer;

  ListenedRun(const Scene& scene, bool adapts, int steps)
      : method(listening(heard, adapts)), simulation(scene, method, dt, steps) {}
  /// The rows at the end of the next step.
  std::size_t step() { return simulation.step(observer).contacts.obstacle; }
  static Method listening(Heard& heard, bool adapts) {
    Method method = test::fixed_method("log", 1);
    method.stiffness = std::make_unique<Listening>(heard, adapts);
    return method;
  }
};

TEST(StepEnd, lists_every_pair_with_both_gaps_and_its_own_stop_level) {
  const Scene scene = two_particles();
  ListenedRun run(scene, true, 3);
  Positions before(3, 2);
  for (int i = 0; i < 3; ++i) {
    before = run.simulation.history().x;
    ASSERT_EQ(run.step(), 2U);
  }
  ASSERT_EQ(run.heard.size(), 3U);
  EXPECT_TRUE(run.heard[0].empty());  // no step before
  ASSERT_EQ(run.heard[2].size(), 2U);
  for (const int v : {0, 1}) {
    const StiffnessPolicy::PairEnd& pair = run.heard[2][static_cast<std::size_t>(v)];
    EXPECT_EQ(pair.gap, run.simulation.history().x(2, v));
    EXPECT_EQ(pair.gap_before, before(2, v));
    EXPECT_EQ(pair.park,
              run.method.contact_options.min_gap_fraction * scene.d_hat[static_cast<std::size_t>(v)]);
  }
}

/// Two rods that cross at an angle of 0.04, nearly parallel, and drift towards each other.
TEST(StepEnd, lists_nearly_parallel_edges) {
  Scene scene;
  test::add_body(scene, "rod", {Vec3d(-0.5, 0, 0), Vec3d(0.5, 0, 0)}, {}, d_hat);
  test::add_body(scene, "other", {Vec3d(-0.5, -0.01, 0.008), Vec3d(0.5, 0.01, 0.008)}, {}, d_hat);
  scene.surface_edges = {{0, 1}, {2, 3}};
  scene.v0.rightCols(2).row(2).setConstant(-0.1);
  Heard heard;
  Method method = ListenedRun::listening(heard, true);
  Simulation simulation(scene, method, dt, 2);
  StepObserver nobody;
  const auto gap = [&] { return test::rows_of(simulation.system()).mollified.d.at(0); };
  ASSERT_EQ(simulation.step(nobody).contacts.mollified, 1U);
  const double before = gap();
  ASSERT_EQ(simulation.step(nobody).contacts.mollified, 1U);
  ASSERT_EQ(heard.size(), 2U);
  ASSERT_EQ(heard[1].size(), 1U);
  EXPECT_EQ(heard[1][0].gap, gap());
  EXPECT_EQ(heard[1][0].gap_before, before);
  EXPECT_LT(gap(), before);
  EXPECT_EQ(heard[1][0].park, method.contact_options.min_gap_fraction * d_hat);
}

TEST(StepEnd, leaves_a_pair_out_that_had_no_row_before) {
  Scene scene = two_particles();
  scene.x0(2, 0) = scene.rest(2, 0) = 1.1 * d_hat;  // reaches its d_hat in the second step
  ListenedRun run(scene, true, 3);
  std::vector<std::size_t> rows;
  for (int i = 0; i < 3; ++i) rows.push_back(run.step());
  ASSERT_EQ(rows, (std::vector<std::size_t>{1, 2, 2}));
  EXPECT_EQ(run.heard[1].size(), 1U);
  EXPECT_EQ(run.heard[2].size(), 2U);
}

TEST(StepEnd, does_not_disturb_a_policy_that_never_adapts) {
  const Scene scene = two_particles();
  ListenedRun run(scene, false, 2);
  for (int i = 0; i < 2; ++i) ASSERT_EQ(run.step(), 2U);
  EXPECT_TRUE(run.heard.empty());
}

}  // namespace
}  // namespace bb::step_end_test
