// Every linear solver on one step of a cloth that buckles: the same state, within the tolerance that the step
// was requested, and counts that say what was done.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/newton/buckling_step.hpp"

namespace bb::inexact_solves_test {
namespace {

using namespace test;

Method solved_by(const std::string& name, const std::string& preconditioner = "",
                 const std::string& forcing = "eisenstat_walker") {
  Method method = method_with(StepHessian::blend);
  method.linear.name = name;
  if (!preconditioner.empty()) method.linear.parameters["preconditioner"] = preconditioner;
  method.linear.parameters["forcing"] = forcing;
  return method;
}

/// What the solves of a step had to do.
struct Tolerances final : StepObserver {
  void on_iteration(const IterationReport& report) override {
    of.push_back(report.solve.linear.tolerance);
    residual.push_back(report.residual_true);
  }
  std::vector<double> of, residual;
};

constexpr double mild = 0.999;  // of the width: the step has one minimum

/// That of the mild step to a thousandth of the tolerance, by a direct solver.
const Positions& reference() {
  static const Positions x = OneStep(method_with(StepHessian::blend, 1e-9), mild).x();
  return x;
}

/// The minimum that a state is next to: ten steps of Newton's method from it, by a direct solver.
Positions minimum_at(const Scene& scene, const Positions& x) {
  Method method = method_with(StepHessian::blend);
  NewtonSystem system(scene, method);
  Prediction prediction;
  prediction.x_tilde = scene.x0;
  prediction.c = 1;
  system.begin_step(scene.x0, prediction, dt, 1);
  system.assemble();
  Positions next = x, dx = x - scene.x0;
  for (int k = 0; k < 10; ++k) {
    EXPECT_TRUE(test::try_state(system, next).has_value());
    system.accept();
    system.assemble();
    EXPECT_EQ(test::solve(system, system.view().x(), dx).linear.status, LinearStatus::ok);
    EXPECT_TRUE(system.diagnosis().solved_is_exact());  // no saddle
    next = system.view().x() + dx;
  }
  EXPECT_LT(dx.cwiseAbs().maxCoeff(), 1e-5 * tolerance);
  return system.view().x();
}

struct Choice {
  std::string solver, preconditioner, forcing;
};
void PrintTo(const Choice& choice, std::ostream* out) {
  *out << choice.solver << " " << choice.preconditioner;
}
std::vector<Choice> choices() {
  std::vector<Choice> out;
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (!missing_for(entry.name).empty()) continue;
    if (!entry.iterative) {
      out.push_back({entry.name, "", "eisenstat_walker"});
      continue;
    }
    const bool named = find_named(entry.parameters, "preconditioner") != nullptr;
    for (const char* forcing : {"fixed", "eisenstat_walker"}) {
      const std::vector<std::string> one = {""};
      for (const std::string& each : named ? preconditioners().names() : one) {
        out.push_back({entry.name, each, forcing});
      }
    }
  }
  return out;
}

class InexactSolves : public testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(All, InexactSolves, testing::ValuesIn(choices()), [](const auto& one) {
  return one.param.solver + "_" + one.param.preconditioner + "_" + one.param.forcing;
});

TEST_P(InexactSolves, reach_one_state_within_three_tolerances) {
  const auto& [solver, preconditioner, forcing] = GetParam();
  const OneStep step(solved_by(solver, preconditioner, forcing), mild);
  ASSERT_EQ(step.report.status, StepStatus::converged) << step.report.detail;
  ASSERT_GT(step.watch.contacts, 5U);
  EXPECT_GT((step.x() - step.scene.x0).cwiseAbs().maxCoeff(), 1e4 * tolerance);
  EXPECT_LT((step.x() - reference()).cwiseAbs().maxCoeff(), 3 * tolerance);
  EXPECT_LT(step.watch.estimate, tolerance);
}

/// Where it buckles another path may lead to another minimum; the state is within the tolerance of one.
TEST_P(InexactSolves, end_in_a_minimum_within_three_tolerances) {
  const auto& [solver, preconditioner, forcing] = GetParam();
  const OneStep step(solved_by(solver, preconditioner, forcing));
  ASSERT_EQ(step.report.status, StepStatus::converged) << step.report.detail;
  ASSERT_GT(step.watch.contacts, 5U);
  EXPECT_LT((step.x() - minimum_at(step.scene, step.x())).cwiseAbs().maxCoeff(), 3 * tolerance);
  EXPECT_LT(step.watch.estimate, tolerance);
  EXPECT_LT(step.report.newton_iterations, 60);
}

TEST(InexactSolves, a_lagged_factor_serves_most_solves) {
  const OneStep direct(solved_by("cholmod")), lagged(solved_by("lagged_cholesky"));
  EXPECT_EQ(direct.report.linear_iterations, 0);
  EXPECT_GE(direct.report.factorizations, direct.report.newton_iterations);
  EXPECT_GT(lagged.report.factorizations, 0);
  EXPECT_LT(2 * lagged.report.factorizations, lagged.report.newton_iterations);
  EXPECT_GT(lagged.report.linear_iterations, lagged.report.newton_iterations);
}

TEST(InexactSolves, are_as_loose_as_newton_allows) {
  for (const char* name : {"pcg", "lagged_cholesky"}) {
    Scene scene = buckling_cloth();
    Method method = solved_by(name);
    Simulation simulation(scene, method, dt, 1);
    Tolerances tolerances;
    const StepReport report = simulation.step(tolerances);
    ASSERT_EQ(report.status, StepStatus::converged);
    ASSERT_GE(tolerances.of.size(), 5U);
    EXPECT_EQ(tolerances.of.front(), 0.1);
    EXPECT_LE(*std::max_element(tolerances.of.begin(), tolerances.of.end()), 0.1);
    EXPECT_LT(*std::min_element(tolerances.of.begin(), tolerances.of.end()), 1e-2);  // the end is fast
    for (std::size_t i = 0; i < tolerances.of.size(); ++i) {
      EXPECT_LE(tolerances.residual[i], tolerances.of[i]);
    }
    const OneStep tight(solved_by(name, "", "fixed"));
    EXPECT_LT(3 * report.linear_iterations, 2 * tight.report.linear_iterations) << name;
  }
}

/// A corner that is led 5 mm along the cloth: it is at its pose after the first iteration.
TEST(InexactSolves, go_further_while_a_prescribed_vertex_has_to_move) {
  for (const char* name : {"pcg", "lagged_cholesky"}) {
    Scene scene = buckling_cloth(mild);
    scene.pins = {{0, 0}};
    scene.motions.resize(1);
    scene.motions[0].velocity = Vec3d(0.5, 0, 0);
    Method method = solved_by(name);
    Simulation simulation(scene, method, dt, 1);
    Tolerances tolerances;
    const StepReport report = simulation.step(tolerances);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    EXPECT_NEAR(simulation.history().x(0, 0), scene.x0(0, 0) + 0.5 * dt, 1e-15);
    const auto moving = std::count(tolerances.of.begin(), tolerances.of.end(), 1e-3);
    ASSERT_GE(moving, 1) << name;
    ASSERT_LT(static_cast<std::size_t>(moving), tolerances.of.size()) << name;
    EXPECT_EQ(tolerances.of.front(), 1e-3) << name;
    EXPECT_EQ(tolerances.of[static_cast<std::size_t>(moving)], 0.1) << "at its pose, as the first of a step";
    EXPECT_LE(tolerances.residual.front(), 1e-3);
  }
}

TEST(InexactSolves, have_the_same_bits_for_any_number_of_threads) {
  for (const Choice& choice : choices()) {
    if (choice.forcing == "fixed" || choice.preconditioner == "none") continue;
    std::vector<Positions> x;
    for (const std::size_t threads : {1U, 2U, 3U}) {
      tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      x.push_back(OneStep(solved_by(choice.solver, choice.preconditioner)).x());
    }
    EXPECT_EQ(x[0], x[1]) << choice.solver << choice.preconditioner;
    EXPECT_EQ(x[0], x[2]) << choice.solver << choice.preconditioner;
  }
}

/// A particle in quasi-statics, out of reach of the plane: its block of the matrix is 0.
TEST(InexactSolves, a_vertex_without_stiffness_is_named) {
  for (const std::string name : {"jacobi", "block_jacobi", "ic0", "schwarz"}) {
    Scene scene = particle_over_plane(0.2, 1, 0.01);
    Method method = fixed_method("log", 1, "quasi_static");
    method.linear.name = "pcg";
    method.linear.parameters["preconditioner"] = name;
    Simulation simulation(scene, method, 0.01, 1);
    StepObserver observer;
    const StepReport report = simulation.step(observer);
    EXPECT_EQ(report.status, StepStatus::linear_failed);
    EXPECT_NE(report.detail.find("preconditioner_indefinite: the diagonal block of vertex 0 is 0"),
              std::string::npos)
        << report.detail;
    EXPECT_NE(report.detail.find(name + " needs"), std::string::npos) << report.detail;
  }
}

}  // namespace
}  // namespace bb::inexact_solves_test
