// What one Newton system costs when its first matrix is refused: the work of all attempts, not that of the last one.
#include <gtest/gtest.h>

#include <string>

#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/newton/buckling_step.hpp"

namespace bb::attempts_test {
namespace {

using namespace test;

/// The cloth that buckles at the start of its step: its exact matrix is not positive definite, the clamped one is.
struct AtStart {
  Scene scene = buckling_cloth();
  Method method = method_with(StepHessian::exact_or_clamped);
  NewtonSystem system;

  explicit AtStart(const std::string& solver) : system(scene, with(solver)) {
    Prediction at_rest;
    at_rest.x_tilde = scene.x0;
    system.begin_step(scene.x0, at_rest, dt, 1);
    system.assemble();
    system.set_target(system.view().x());
  }
  Method& with(const std::string& solver) {
    method.linear.name = solver;
    if (solver != "pcg") return method;
    method.linear.parameters["forcing"] = "fixed";
    method.linear.parameters["preconditioner"] = "none";  // so that the refused matrix costs iterations
    return method;
  }
};

class AttemptsOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, AttemptsOf, testing::Values("cholmod", "lagged_cholesky", "pcg"),
                         [](const auto& one) { return std::string(one.param); });

/// The same two matrices, solved one after the other by a solver of its own.
TEST_P(AttemptsOf, AddUpTheirWork) {
  AtStart at(GetParam());
  const SolveReport report = at.system.find_direction();
  ASSERT_EQ(report.linear.status, LinearStatus::ok);
  ASSERT_EQ(report.attempts, 2);
  EXPECT_EQ(report.fallbacks(), 1);
  EXPECT_EQ(report.t, 1);

  const std::unique_ptr<LinearSolver> solver = make_linear_solver(at.method.linear);
  solver->begin_step();
  VecXd solution;
  const LinearReport refused =
      solver->solve(at.system.diagnosis().exact(), at.system.diagnosis().rhs(), solution);
  const LinearReport served =
      solver->solve(at.system.diagnosis().solved(), at.system.diagnosis().rhs(), solution);
  ASSERT_EQ(refused.status, LinearStatus::matrix_indefinite);
  ASSERT_EQ(served.status, LinearStatus::ok);
  EXPECT_EQ(report.linear.iterations, refused.iterations + served.iterations);
  EXPECT_EQ(report.factorizations, int(refused.factorized) + int(served.factorized));
  EXPECT_EQ(report.analyses, int(refused.analyzed) + int(served.analyzed));
  EXPECT_EQ(report.factor_flop, refused.factor_flop + served.factor_flop);
  EXPECT_EQ(report.linear.residual_true,
            served.residual_true);  // what is reported of the direction is the last one's
  if (std::string(GetParam()) == "pcg") {
    EXPECT_GT(refused.iterations, 0);
    EXPECT_GT(served.iterations, 0);
  }
}

/// The next solve at the level that served has one attempt, and the work of one.
TEST_P(AttemptsOf, DoNotCountInTheNextSystem) {
  AtStart at(GetParam());
  const SolveReport first = at.system.find_direction(), again = at.system.find_direction();
  ASSERT_EQ(first.attempts, 2);
  EXPECT_EQ(again.attempts, 1);
  EXPECT_LE(again.factorizations, first.factorizations);
  if (std::string(GetParam()) != "pcg") return;
  EXPECT_GT(again.linear.iterations, 0);
  EXPECT_LT(again.linear.iterations, first.linear.iterations);
}

/// In trace and record: an iteration has the sums over its attempts, a step those over its iterations.
TEST(Attempts, AreInTheNumbersOfTheirIterationAndStep) {
  class Sums final : public StepObserver {
   public:
    void on_iteration(const IterationReport& report) override {
      EXPECT_EQ(report.linear_iterations, report.solve.linear.iterations);
      EXPECT_EQ(report.linear_solves, report.solve.attempts + report.solve.corrections);
      EXPECT_EQ(report.hessian_fallbacks, report.solve.attempts - 1);
      solves += report.linear_solves, iterations += report.linear_iterations;
      refused += report.hessian_fallbacks;
    }
    long long solves = 0, iterations = 0, refused = 0;
  } sums;
  const Scene scene = buckling_cloth(0.99);
  Method method = method_with(StepHessian::exact_or_clamped);
  method.linear.name = "pcg";
  Simulation simulation(scene, method, dt, 1);
  const StepReport report = simulation.step(sums);
  ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
  ASSERT_GT(sums.refused, 0);
  EXPECT_EQ(report.linear_solves, sums.solves);
  EXPECT_EQ(report.linear_iterations, sums.iterations);
  EXPECT_EQ(report.hessian_fallbacks, sums.refused);
}

}  // namespace
}  // namespace bb::attempts_test
