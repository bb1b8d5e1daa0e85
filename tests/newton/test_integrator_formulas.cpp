// Every step of a run satisfies the formula of its integrator and the law of motion at its end, with the forces written out by hand:
// particles on springs, one of them let go in the middle of the run, and pulls that begin and end. Only a step from which on other
// vertices are prescribed or other pulls act starts anew: bdf2 with one step of first order, newmark with an acceleration of the
// forces of now.
#include <gtest/gtest.h>

#include <set>

#include "tests/newton/small_scenes.hpp"

namespace bb::integrator_formulas_test {
namespace {

constexpr double dt = 0.01, infinite = std::numeric_limits<double>::infinity();
constexpr int n_steps = 20;
const std::set<int> anew = {0, 4, 7, 10, 13};  // the steps that start anew

/// Three particles of 0.2 kg that springs pull sideways from the start; the second is held for four steps. Two more pulls begin, one
/// of them within a step and one with it, and the first of them ends.
Scene particles() {
  Scene scene = test::particle_over_plane(0.2, 1, 0.01);
  scene.obstacles.clear();
  scene.bodies = {{"particles", 0, 3}};
  scene.x0.resize(3, 3);
  scene.x0 << 0, 1, 2, 0, 0, 0, 1, 1, 1;
  scene.rest = scene.x0;
  scene.v0 = Positions::Zero(3, 3);
  scene.v0.col(0) = Vec3d(0.3, -0.2, 0.5);
  scene.mass.assign(3, 0.2);
  scene.body.assign(3, 0);
  scene.d_hat.assign(3, 0.01);
  scene.offset.assign(3, 0);
  scene.surface_vertices = {0, 1, 2};
  scene.motions.resize(2);
  scene.motions[1].keyframes = {{0, Vec3d(0.1, 0, 0), 0, 1}};
  scene.pins = {{1, 0, {-infinite, 4 * dt}}};
  for (const int v : {0, 2}) scene.pulls.push_back({{v}, 1, 30, {}, {-infinite, infinite}});
  scene.pulls.push_back({{0}, 1, 20, {}, {6.8 * dt, 9.8 * dt}});
  scene.pulls.push_back({{1}, 1, 40, {}, {13 * dt, infinite}});
  return scene;
}

/// m/s^2 of particle v at x while the step of that number acts.
Vec3d acceleration(const Scene& scene, int v, const Vec3d& x, int step) {
  Vec3d out = scene.gravity;
  for (const Pull& pull : scene.pulls) {
    const double middle = (step + 0.5) * dt;
    if (pull.vertices[0] != v || middle < pull.span.hold || middle > pull.span.release) continue;
    const Vec3d target = scene.x0.col(v) + Vec3d(0.1, 0, 0);
    out += pull.stiffness / scene.mass[static_cast<std::size_t>(v)] * (target - x);
  }
  return out;
}

struct Run {
  std::vector<Positions> x, v;  // before the first step and after each
};

Run run_of(const Scene& scene, const std::string& integrator) {
  Method method = test::fixed_method("log", 1, integrator);
  method.step_solver.tol_velocity = 1e-11;
  Simulation simulation(scene, method, dt, n_steps);
  StepObserver observer;
  Run out{{scene.x0}, {scene.v0}};
  for (int step = 0; step < n_steps; ++step) {
    EXPECT_EQ(simulation.step(observer).status, StepStatus::converged);
    out.x.push_back(simulation.history().x);
    out.v.push_back(simulation.history().v);
  }
  return out;
}

/// What happens in one step to one particle.
struct Step {
  Vec3d x_prev, x0, x1, v_prev, v0, v1, a1;
};

/// Calls `judge(step, what, starts anew)` for every step of a free particle.
template <class Judge>
int for_each_step(const Scene& scene, const Run& run, Judge judge) {
  int judged = 0;
  for (int v = 0; v < 3; ++v) {
    for (int n = v == 1 ? 4 : 0; n < n_steps; ++n, ++judged) {
      const auto at = static_cast<std::size_t>(n), before = at == 0 ? 0 : at - 1;
      Step of;
      of.x_prev = run.x[before].col(v), of.x0 = run.x[at].col(v), of.x1 = run.x[at + 1].col(v);
      of.v_prev = run.v[before].col(v), of.v0 = run.v[at].col(v), of.v1 = run.v[at + 1].col(v);
      of.a1 = acceleration(scene, v, of.x1, n);
      SCOPED_TRACE("particle " + std::to_string(v) + ", step " + std::to_string(n));
      judge(of, v, n);
      if (::testing::Test::HasFailure()) return 0;
    }
  }
  return judged;
}

void expect_zero(const Vec3d& way, double most) { EXPECT_LT(way.cwiseAbs().maxCoeff(), most); }

TEST(IntegratorFormulas, HoldInEveryStepOfImplicitEuler) {
  const Scene scene = particles();
  const int judged = for_each_step(scene, run_of(scene, "implicit_euler"), [](const Step& of, int, int) {
    expect_zero(of.x1 - of.x0 - dt * of.v1, 1e-13);
    expect_zero(of.v1 - of.v0 - dt * of.a1, 1e-8);
  });
  EXPECT_EQ(judged, 56);
}

TEST(IntegratorFormulas, HoldInEveryStepOfBdf2) {
  const Scene scene = particles();
  const int judged = for_each_step(scene, run_of(scene, "bdf2"), [](const Step& of, int, int n) {
    if (anew.contains(n)) {
      expect_zero(of.x1 - of.x0 - dt * of.v1, 1e-13);
      expect_zero(of.v1 - of.v0 - dt * of.a1, 1e-8);
    } else {
      expect_zero(3 * of.x1 - 4 * of.x0 + of.x_prev - 2 * dt * of.v1, 1e-13);
      expect_zero(3 * of.v1 - 4 * of.v0 + of.v_prev - 2 * dt * of.a1, 1e-8);
    }
  });
  EXPECT_EQ(judged, 56);
}

/// The acceleration at the start of a step is that of its forces: at a start anew those that act from now on.
TEST(IntegratorFormulas, HoldInEveryStepOfNewmark) {
  const Scene scene = particles();
  const int judged = for_each_step(scene, run_of(scene, "newmark"), [&](const Step& of, int v, int n) {
    const Vec3d a0 = acceleration(scene, v, of.x0, anew.contains(n) ? n : n - 1);
    expect_zero(of.x1 - of.x0 - dt * of.v0 - dt * dt / 4 * (a0 + of.a1), 1e-10);
    expect_zero(of.v1 - of.v0 - dt / 2 * (a0 + of.a1), 1e-8);
  });
  EXPECT_EQ(judged, 56);
}

}  // namespace
}  // namespace bb::integrator_formulas_test
