// Steps of pncg: that they are linear conjugate gradients where E is quadratic, that they end where line_search does, what bounds
// an iteration, and that a direction descends whatever the gradient was.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/math/error.hpp"
#include "core/step_solvers/dai_kou.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/converged_steps.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::pncg_test {
namespace {

constexpr double d_hat = 0.01;  // m

Method method_of(double epsilon, const std::string& bound = "accd",
                 const std::string& preconditioner = "jacobi") {
  Method method = test::fixed_method("log", 100);
  choose_step_solver(method, "pncg");
  method.step_solver.max_iterations = 5000;
  method.step_solver.saddle = SaddleRule::ignore;
  method.step_solver.parameters["pncg_epsilon"] = epsilon;
  method.step_solver.parameters["pncg_bound"] = bound;
  method.step_solver.parameters["pncg_preconditioner"] = preconditioner;
  fit_terms(method);
  return method;
}

Method newton_method() {
  Method method = test::fixed_method("log", 100);
  method.step_solver.tol_velocity = 1e-9;
  fit_terms(method);
  return method;
}

/// Particles of different masses in a row, without contact: neighbours pull at each other like springs of length 0, so E is
/// quadratic.
Scene chain(int n) {
  Scene scene;
  scene.name = "chain";
  scene.bodies = {{"chain", 0, n}};
  scene.x0.resize(3, n);
  for (int i = 0; i < n; ++i) {
    scene.x0.col(i) = Vec3d(0.1 * i, 0.03 * i * i, 0.02 * (i % 3));
    scene.mass.push_back(0.1 + 0.07 * i);
    scene.body.push_back(0);
    scene.d_hat.push_back(d_hat);
    scene.offset.push_back(0);
    if (i == 0) continue;
    scene.stitches.pairs.push_back({i - 1, i});
    scene.stitches.stiffness.push_back(100.0 * i);
    scene.stitches.rest_length.push_back(0);
  }
  scene.rest = scene.x0;
  scene.v0 = Positions::Zero(3, n);
  scene.gravity = Vec3d(0, 0, -10);
  return scene;
}

/// Matrix and gradient of the first iteration, and every state.
struct Watch final : StepObserver {
  Eigen::MatrixXd h;
  VecXd g;
  std::vector<Positions> states;
  std::size_t nnz = 0;
  void on_matrix(StepSystem& system, int, int iteration) override {
    if (iteration > 0) return;
    Diagnosis& at = system.on_host().diagnosis();
    h = Eigen::MatrixXd(at.solved().lower).selfadjointView<Eigen::Lower>();
    at.blocks().restrict_vector(at.gradient(), g);
    states.push_back(at.x());
  }
  void on_iteration(const IterationReport& report) override { nnz = report.nnz; }
  void on_motion(const Positions&, const Positions& x1, int) override { states.push_back(x1); }
};

/// States of linear conjugate gradients for H s = -g with M = diag(H), by the textbook.
std::vector<VecXd> linear_states(const Eigen::MatrixXd& h, const VecXd& g, int count) {
  const VecXd inverse = h.diagonal().cwiseInverse();
  VecXd s = VecXd::Zero(g.size()), r = -g, z = inverse.cwiseProduct(r), p = z;
  std::vector<VecXd> out = {s};
  for (int k = 0; k < count; ++k) {
    const double before = r.dot(z), alpha = before / p.dot(h * p);
    s += alpha * p;
    r -= alpha * (h * p);
    z = inverse.cwiseProduct(r);
    p = z + r.dot(z) / before * p;
    out.push_back(s);
  }
  return out;
}

TEST(Pncg, IsLinearConjugateGradientsWhereEIsQuadratic) {
  const Scene scene = chain(7);
  Method method = method_of(1e-24);
  Simulation simulation(scene, method, 0.05, 1);
  Watch watch;
  const StepReport step = simulation.step(watch);
  ASSERT_EQ(step.status, StepStatus::converged) << step.detail;
  EXPECT_GT((watch.h - Eigen::MatrixXd(watch.h.diagonal().asDiagonal())).norm(), 1);  // not for the diagonal
  constexpr int count = 6;
  ASSERT_GT(watch.states.size(), static_cast<std::size_t>(count));
  const std::vector<VecXd> linear = linear_states(watch.h, watch.g, count);
  for (int k = 1; k <= count; ++k) {
    const Positions moved = watch.states[static_cast<std::size_t>(k)] - watch.states[0];
    const Eigen::Map<const VecXd> found(moved.data(), moved.size());
    EXPECT_GT(found.norm(), 1e-3);
    EXPECT_LT((found - linear[static_cast<std::size_t>(k)]).norm(), 1e-10 * found.norm()) << k;
  }
  const VecXd solution = watch.h.ldlt().solve(-watch.g);
  const Positions end = simulation.history().x - watch.states[0];
  EXPECT_LT((Eigen::Map<const VecXd>(end.data(), end.size()) - solution).norm(), 1e-8 * solution.norm());
  EXPECT_GT(watch.nnz, 21U);  // more than the diagonal
}

/// By hand, P = 1: y.p = 4, g.Py = 5, y.Py = 5, g.p = 6.
TEST(Pncg, BetaIsThatOfDaiAndKou) {
  VecXd g(2), y(2), p(2);
  g << 1, 2;
  y << 1, 2;
  p << 2, 1;
  EXPECT_DOUBLE_EQ(dai_kou(g, y, y, p), (5 - 5 * 4.0 / 4) / 4);
  g << 3, 1;
  EXPECT_DOUBLE_EQ(dai_kou(g, y, y, p), (5 - 5 * 7.0 / 4) / 4);
  VecXd half(2);
  half << 0.5, 0.5;  // P = diag(1/2, 1/4)
  EXPECT_DOUBLE_EQ(dai_kou(g, y, half, p), (2 - 1.5 * 7.0 / 4) / 4);
}

/// g.p_next <= -(3/4) g.Pg for every g, y and p, descending or not; the bound is nearly met somewhere.
TEST(Pncg, ADirectionDescendsWhateverTheLastOneWas) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  double least = 1e9;
  for (int trial = 0; trial < 20000; ++trial) {
    VecXd g(2), y(2), p(2), inverse(2);
    for (VecXd* each : {&g, &y, &p, &inverse}) *each << normal(random), normal(random);
    inverse = inverse.cwiseAbs();
    const VecXd Pg = inverse.cwiseProduct(g), Py = inverse.cwiseProduct(y);
    const VecXd next = dai_kou(g, y, Py, p) * p - Pg;
    if (!next.allFinite()) continue;
    const double part = -g.dot(next) / g.dot(Pg);
    EXPECT_GT(part, 0.75 - 1e-6);
    least = std::min(least, part);
  }
  EXPECT_LT(least, 0.76);
}

Scene cloth_over_floor(double height) {
  SceneBuilder builder("cloth on a floor", false, Vec3d(0, 0, -10), "test");
  builder.add_body(test::cloth_spec(6, height, d_hat));
  Obstacle plane;
  plane.name = "floor";
  builder.add_obstacle(plane);
  return builder.finish();
}

struct Ran {
  Positions x;
  StepReport last;
  int iterations = 0;
  double bounds = 0, rises = 0;
};

Ran run(const Scene& scene, Method method, int steps, double dt = 0.01) {
  Ran out;
  out.x = test::converged_steps(scene, method, dt, steps, [&](const StepReport& report) {
    out.last = report;
    out.iterations += report.newton_iterations;
    if (method.step_solver.name != "pncg") return;
    out.bounds += report.solver.values.at("pncg_bounds");
    out.rises += report.solver.values.at("pncg_rises");
    EXPECT_LE(report.solver.values.at("pncg_fall"), 1);
  });
  return out;
}

/// With each of its preconditioners, contacts and two ways to bound an iteration.
TEST(Pncg, EndsWhereLineSearchDoes) {
  const Scene scene = cloth_over_floor(0.8 * d_hat);
  const Ran newton = run(scene, newton_method(), 6);
  ASSERT_GT(newton.last.contacts.total(), 0);
  EXPECT_GT(newton.last.contact_load_max_N.value, 1e-3);
  EXPECT_GT((newton.x - scene.x0).cwiseAbs().maxCoeff(), 1e-3);
  for (const char* bound : {"accd", "half_d_hat"}) {
    for (const char* preconditioner : {"none", "jacobi", "block_jacobi", "ic0"}) {
      const Ran ran = run(scene, method_of(1e-16, bound, preconditioner), 6);
      EXPECT_LT((ran.x - newton.x).cwiseAbs().maxCoeff(), 1e-6) << bound << " " << preconditioner;
      EXPECT_GT(ran.iterations, newton.iterations);
      EXPECT_GT(ran.last.gap_min_m.value, 0);
    }
  }
}

/// The rule of the paper's end: a larger epsilon costs fewer iterations and ends farther off, and says both.
TEST(Pncg, EpsilonIsWhatAStepStopsAt) {
  const Scene scene = cloth_over_floor(0.8 * d_hat);
  const Ran newton = run(scene, newton_method(), 1);
  double apart = 0;
  int iterations = 1 << 30;
  for (const double epsilon : {1e-12, 1e-6, 1e-2}) {
    const Ran ran = run(scene, method_of(epsilon), 1);
    EXPECT_LE(ran.last.solver.values.at("pncg_fall"), epsilon);
    EXPECT_EQ(ran.last.linear_solves, 0);
    EXPECT_EQ(ran.last.hessian_fallbacks, 0);
    EXPECT_GT(ran.last.solver.values.at("pncg_fall"), 0);
    EXPECT_LT(ran.iterations, iterations);
    const double off = (ran.x - newton.x).cwiseAbs().maxCoeff();
    EXPECT_GT(off, apart);
    apart = off;
    iterations = ran.iterations;
  }
}

/// Far from the first one, at rest.
void add_particle_of_wide_d_hat(Scene& scene) {
  scene.bodies.push_back({"wide", 1, 1});
  for (Positions* of : {&scene.rest, &scene.x0, &scene.v0}) {
    of->conservativeResize(3, 2);
    of->col(1) = of == &scene.v0 ? Vec3d(0, 0, 0) : Vec3d(1, 0, 1);
  }
  scene.mass.push_back(scene.mass[0]);
  scene.body.push_back(1);
  scene.d_hat.push_back(3 * scene.d_hat[0]);
  scene.offset.push_back(0);
  scene.surface_vertices.push_back(1);
}

/// As published no vertex goes farther than d_hat / 2 in an iteration, near a surface or not; of bodies that differ in d_hat the
/// smallest one counts.
TEST(Pncg, HalfOfDHatBoundsEveryMotion) {
  struct Longest final : StepObserver {
    double m = 0;
    void on_motion(const Positions& x0, const Positions& x1, int) override {
      m = std::max(m, (x1 - x0).colwise().norm().maxCoeff());
    }
  };
  Scene scene = test::particle_over_plane(0.2, 1, d_hat);
  scene.v0(2, 0) = -9.9;  // and 0.1 of gravity: 20 times d_hat/2 in a step
  scene.gravity = Vec3d(0, 0, -10);
  add_particle_of_wide_d_hat(scene);
  for (const char* bound : {"accd", "half_d_hat"}) {
    Method method = method_of(1e-12, bound);
    Simulation simulation(scene, method, 0.01, 1);
    Longest longest;
    const StepReport step = simulation.step(longest);
    ASSERT_EQ(step.status, StepStatus::converged);
    EXPECT_NEAR(simulation.history().x(2, 0), 0.9, 1e-9);
    const bool published = std::string(bound) == "half_d_hat";
    EXPECT_NEAR(longest.m, published ? d_hat / 2 : 0.1, 1e-9);
    EXPECT_GE(step.newton_iterations, published ? 20 : 1);
    EXPECT_EQ(step.solver.values.at("pncg_bounds") > 0, published);
  }
}

/// An impact of ten times d_hat a step is stopped by ACCD above the floor.
TEST(Pncg, AccdStopsWhatIsFast) {
  Scene scene = test::particle_over_plane(0.2, 0.9 * d_hat, d_hat);
  scene.v0(2, 0) = -10;
  const Ran ran = run(scene, method_of(1e-10), 3);
  EXPECT_GT(ran.x(2, 0), 0);
  EXPECT_GT(ran.bounds, 0);
  EXPECT_EQ(ran.rises, 0);
}

/// What led into a contact is not kept: after a motion that ACCD bounded the direction is that of -P g, and of others not.
TEST(Pncg, BeginsAnewAfterAMotionThatContactBounded) {
  struct Angles final : StepObserver {
    double bounded_before = 1, others = 1;  // least cosine of dx and -P g
    bool bounded = false;
    void on_matrix(StepSystem& system, int, int iteration) override {
      Diagnosis& at = system.on_host().diagnosis();
      const VecXd diagonal = Eigen::MatrixXd(at.solved().lower).diagonal();
      VecXd g, dx;
      at.blocks().restrict_vector(at.gradient(), g);
      at.blocks().restrict_vector(at.direction(), dx);
      const VecXd down = -g.cwiseQuotient(diagonal);
      const double cosine = dx.dot(down) / (dx.norm() * down.norm());
      if (iteration > 0)
        (bounded ? bounded_before : others) = std::min(cosine, bounded ? bounded_before : others);
    }
    void on_iteration(const IterationReport& report) override { bounded = report.alpha_ccd < 1; }
  };
  Scene scene = cloth_over_floor(0.8 * d_hat);
  scene.v0.row(2).array() = -3;
  scene.v0(2, 0) = -5;
  Method method = method_of(1e-10);
  Simulation simulation(scene, method, 0.01, 1);
  Angles angles;
  const StepReport step = simulation.step(angles);
  EXPECT_GT(step.solver.values.at("pncg_bounds"), 0);
  EXPECT_NEAR(angles.bounded_before, 1, 1e-12);
  EXPECT_LT(angles.others, 0.99);
}

TEST(Pncg, AStepThatDoesNotEndSaysSo) {
  const Scene scene = cloth_over_floor(0.8 * d_hat);
  Method method = method_of(1e-12);
  method.step_solver.max_iterations = 5;
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver none;
  const StepReport step = simulation.step(none);
  EXPECT_EQ(step.status, StepStatus::iteration_cap);
  EXPECT_EQ(step.newton_iterations, 5);
}

TEST(Pncg, DoesNotDependOnTheNumberOfThreads) {
  const Scene scene = cloth_over_floor(0.8 * d_hat);
  Positions end[2];
  for (const int threads : {1, 3}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
    const Ran ran = run(scene, method_of(1e-8), 3);
    EXPECT_GT(ran.last.contacts.total(), 0);
    end[threads == 1 ? 0 : 1] = ran.x;
  }
  EXPECT_EQ(end[0], end[1]);
}

TEST(Pncg, RefusesWhatIsDriven) {
  Scene scene = test::particle_over_plane(0.2, 1, d_hat);
  PrescribedMotion motion;
  motion.velocity = Vec3d(0, 0, 1);
  ASSERT_FALSE(motion.is_static());
  scene.motions.push_back(motion);
  Method method = method_of(1e-4);
  EXPECT_THROW(Simulation(scene, method, 0.01, 1), ConfigError);
}

}  // namespace
}  // namespace bb::pncg_test
