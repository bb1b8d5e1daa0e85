// What a policy that balances B against the rest of E receives, and how often.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::policy_start_test {
namespace {

constexpr double d_hat = 0.01, dt = 0.002;

class Balancing final : public StiffnessPolicy {
 public:
  explicit Balancing(std::vector<StiffnessGlobals>& heard) : heard_(heard) {}
  std::string_view name() const override { return "balancing"; }
  Refresh refresh() const override { return Refresh::per_iteration; }
  bool needs_globals() const override { return true; }
  void start(const StiffnessGlobals& globals) override { heard_.push_back(globals); }
  void fill(const StiffnessBatch& rows, double* kappa) const override { std::fill_n(kappa, rows.n, 30.0); }

 private:
  std::vector<StiffnessGlobals>& heard_;
};

/// Two particles over a plane, of 0.2 and 0.4 kg, and a third that is far above it.
Scene three_particles() {
  Scene scene = test::particle_over_plane(0.2, 0, d_hat);
  scene.bodies = {{"particles", 0, 3}};
  scene.x0.resize(3, 3);
  scene.x0 << 0, 1, 2, 0, 0, 0, 0.4 * d_hat, 0.7 * d_hat, 1;
  scene.rest = scene.x0;
  scene.v0 = Positions::Zero(3, 3);
  scene.mass = {0.2, 0.4, 100};
  scene.body = {0, 0, 0};
  scene.d_hat.assign(3, d_hat);
  scene.offset.assign(3, 0);
  scene.surface_vertices = {0, 1, 2};
  return scene;
}

TEST(PolicyStart, is_once_a_run_with_the_sums_of_the_first_contacts) {
  const Scene scene = three_particles();
  std::vector<StiffnessGlobals> heard;
  Method method = test::fixed_method("quadratic", 1, "newmark");
  method.stiffness = std::make_unique<Balancing>(heard);
  Simulation simulation(scene, method, dt, 3);
  StepObserver nobody;
  for (int i = 0; i < 3; ++i) ASSERT_EQ(simulation.step(nobody).status, StepStatus::converged);
  ASSERT_EQ(heard.size(), 1U);
  const double one = 2 * 0.6 * d_hat, other = 2 * 0.3 * d_hat;  // |b'| of the quadratic
  EXPECT_NEAR(heard[0].grad_b_sq, one * one + other * other, 1e-15);
  EXPECT_NEAR(heard[0].grad_b_dot_grad_e, -one * 2 - other * 4, 1e-12);  // against weights of 2 and 4 N
  EXPECT_NEAR(heard[0].mean_contact_mass, 0.3, 1e-15);
  EXPECT_EQ(heard[0].d2b_half, 2);
  EXPECT_EQ(heard[0].d_hat, d_hat);
  EXPECT_EQ(heard[0].time.dt, dt);
  EXPECT_EQ(heard[0].time.c, 0.25);
}

/// Vertices that are let go into contact: newmark looks at the forces of that state first, and what the policy received then is
/// forgotten. The policy starts with the sums of the step: weights of 2 and 4 N, and the inertia of an acceleration by weight and
/// contact, at 30 N/m.
TEST(PolicyStart, is_that_of_the_step_and_not_of_the_look_at_its_first_forces) {
  Scene scene = three_particles();
  scene.motions.resize(1);
  for (const int v : {0, 1}) scene.pins.push_back({v, 0, {-1, 2 * dt}});
  std::vector<StiffnessGlobals> heard;
  Method method = test::fixed_method("quadratic", 1, "newmark");
  method.stiffness = std::make_unique<Balancing>(heard);
  Simulation simulation(scene, method, dt, 3);
  StepObserver nobody;
  for (int i = 0; i < 2; ++i) ASSERT_EQ(simulation.step(nobody).contacts.total(), 0U);
  ASSERT_EQ(heard.size(), 0U);
  ASSERT_EQ(simulation.step(nobody).contacts.obstacle, 2U);
  ASSERT_EQ(heard.size(), 2U) << "once by the look, once by the step";
  const double one = 2 * 0.6 * d_hat, other = 2 * 0.3 * d_hat;
  EXPECT_NEAR(heard[0].grad_b_dot_grad_e, -one * 2 - other * 4, 1e-12);
  EXPECT_NEAR(heard[1].grad_b_dot_grad_e, -one * (2 + 2 - 30 * one) - other * (4 + 4 - 30 * other), 1e-12);
}

/// Bodies of unlike d_hat: the smallest of all, whether that body touches or not.
TEST(PolicyStart, is_told_the_smallest_d_hat_of_the_scene) {
  for (const std::size_t narrow : {0U, 1U, 2U}) {
    Scene scene = three_particles();
    scene.d_hat[narrow] = 0.75 * d_hat;
    std::vector<StiffnessGlobals> heard;
    Method method = test::fixed_method("quadratic", 1);
    method.stiffness = std::make_unique<Balancing>(heard);
    Simulation simulation(scene, method, dt, 1);
    StepObserver nobody;
    EXPECT_GT(simulation.step(nobody).contacts.obstacle, 0U);
    ASSERT_EQ(heard.size(), 1U);
    EXPECT_EQ(heard[0].d_hat, 0.75 * d_hat) << narrow;
    EXPECT_EQ(heard[0].d2b_half, 2);
  }
}

/// A step solver that does not have to converge measures its end in a system of its own: for the policy that is no run.
TEST(PolicyStart, is_not_repeated_where_the_end_of_a_step_is_measured) {
  const Scene scene = three_particles();
  std::vector<StiffnessGlobals> heard;
  Method method = test::fixed_method("quadratic", 1);
  method.stiffness = std::make_unique<Balancing>(heard);
  choose_step_solver(method, "accumulated_toi");
  Simulation simulation(scene, method, dt, 3);
  StepObserver nobody;
  for (int i = 0; i < 3; ++i) {
    const StepReport report = simulation.step(nobody);
    ASSERT_EQ(report.status, StepStatus::converged);
    ASSERT_GT(report.contacts.obstacle, 0U);
    ASSERT_TRUE(report.end_error_m.finite());  // it was measured
    EXPECT_EQ(heard.size(), 1U) << i;
  }
}

/// The same of ipc_adaptive: its kappa after each step is its start times a power of two, and never falls.
TEST(PolicyStart, of_ipc_adaptive_is_what_later_steps_go_on_from) {
  const Scene scene = three_particles();
  for (const char* solver : {"line_search", "accumulated_toi"}) {
    Method method = test::fixed_method("log", 1);
    PolicyConfig config;
    config.name = "ipc_adaptive";
    config.parameters["kappa_min_N_per_m"] = 1;
    config.parameters["doubling_gap_m"] = d_hat;  // doubles while the gap shrinks
    method.stiffness = make_policy(config);
    choose_step_solver(method, solver);
    Simulation simulation(scene, method, dt, 12);
    StepObserver nobody;
    simulation.step(nobody);
    const double start = method.stiffness->state().kappa_start;
    ASSERT_GT(start, 0);
    for (int i = 1; i < 12; ++i) {
      ASSERT_GT(simulation.step(nobody).contacts.obstacle, 0U);
      const StiffnessPolicy::State now = method.stiffness->state();
      EXPECT_EQ(now.kappa_start, start) << solver << i;
      EXPECT_EQ(now.kappa, start * (1 << now.doublings)) << solver << i;
    }
    EXPECT_GT(method.stiffness->state().doublings, 3) << solver;
  }
}

TEST(PolicyStart, reads_the_curvature_at_half_of_d_hat) {
  const Scene scene = three_particles();
  std::vector<StiffnessGlobals> heard;
  Method method = test::fixed_method("cubic", 1);
  method.stiffness = std::make_unique<Balancing>(heard);
  Simulation simulation(scene, method, dt, 1);
  StepObserver nobody;
  simulation.step(nobody);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_DOUBLE_EQ(heard[0].d2b_half, 2);  // 4 (1 - 1/2)
}

}  // namespace
}  // namespace bb::policy_start_test
