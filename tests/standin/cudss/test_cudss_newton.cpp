// Steps of Newton's method whose systems cudss solves: the states of CHOLMOD, and a matrix that is not positive definite
// raises the level of the Hessian.
#include "tests/newton/buckling_step.hpp"
#include "tests/standin/cudss/fixture.hpp"

namespace bb {
namespace {

Method solved_by(const char* solver) {
  Method method = test::method_with(StepHessian::blend);
  method.linear.name = solver;
  return method;
}

TEST_F(CudssStandin, AStepEndsInTheStateOfCholmod) {
  constexpr double mild = 0.999;  // of the width: the step has one minimum
  const test::OneStep expected(solved_by("cholmod"), mild), found(solved_by("cudss"), mild);
  ASSERT_EQ(found.report.status, StepStatus::converged) << found.report.detail;
  EXPECT_EQ(found.report.newton_iterations, expected.report.newton_iterations);
  EXPECT_GT(found.watch.contacts, 5U);
  EXPECT_GT((found.x() - found.scene.x0).cwiseAbs().maxCoeff(), 1e4 * test::tolerance);
  EXPECT_LT((found.x() - expected.x()).cwiseAbs().maxCoeff(), test::tolerance);
  EXPECT_GE(standin::cudss().solves, found.report.newton_iterations);
  EXPECT_LT(standin::cudss().analyses, standin::cudss().factorizations);
}

TEST_F(CudssStandin, AnIndefiniteMatrixRaisesTheLevelOfTheHessian) {
  const test::OneStep found(solved_by("cudss"));
  ASSERT_EQ(found.report.status, StepStatus::converged) << found.report.detail;
  EXPECT_GT(found.watch.largest_t, 0);
  EXPECT_GT(standin::cudss().factorizations, standin::cudss().solves);  // those that failed
}

}  // namespace
}  // namespace bb
