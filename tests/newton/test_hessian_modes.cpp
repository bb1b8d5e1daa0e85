// Every choice of Hessian on one step of a cloth that buckles: the same state, within the tolerance that the
// step was requested, by different ways.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/newton/buckling_step.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::hessian_modes_test {
namespace {

using namespace test;

/// The same step to a thousandth of the tolerance.
const Positions& reference() {
  static const Positions x = OneStep(method_with(StepHessian::blend, 1e-9)).x();
  return x;
}

class HessianModes : public testing::TestWithParam<StepHessian> {};
INSTANTIATE_TEST_SUITE_P(All, HessianModes, testing::ValuesIn(all_step_hessians),
                         [](const auto& one) { return std::string(to_string(one.param)); });

TEST_P(HessianModes, reach_one_state_within_three_tolerances) {
  const OneStep step(method_with(GetParam()));
  ASSERT_EQ(step.report.status, StepStatus::converged) << step.report.detail;
  ASSERT_GT(step.watch.contacts, 5U);
  ASSERT_GT((step.x() - step.scene.x0).cwiseAbs().maxCoeff(), 1e5 * tolerance);
  EXPECT_LT((step.x() - reference()).cwiseAbs().maxCoeff(), 3 * tolerance);
  EXPECT_LT(step.watch.estimate, tolerance);
}

TEST_P(HessianModes, say_what_they_tried) {
  const OneStep step(method_with(GetParam()));
  const bool fixed = GetParam() == StepHessian::clamped || GetParam() == StepHessian::absolute;
  EXPECT_EQ(step.report.hessian_fallbacks > 0, !fixed);
  EXPECT_EQ(step.report.linear_solves, step.report.newton_iterations + step.report.hessian_fallbacks);
  EXPECT_EQ(step.watch.differ > 0, GetParam() != StepHessian::clamped);
  const bool blends = GetParam() == StepHessian::blend || GetParam() == StepHessian::exact_or_clamped;
  if (blends) {
    EXPECT_GT(step.watch.largest_t, 0);
  }
}

TEST(BucklingStep, the_exact_hessian_ends_quadratically_and_in_fewer_iterations) {
  const OneStep blend(method_with(StepHessian::blend)), clamped(method_with(StepHessian::clamped));
  ASSERT_GE(blend.watch.dx.size(), 3U);
  const auto n = blend.watch.dx.size();
  EXPECT_LT(blend.watch.dx[n - 1], 0.1 * blend.watch.dx[n - 2]);
  EXPECT_LT(2 * blend.report.newton_iterations, clamped.report.newton_iterations);
}

/// At the start of the step the cloth curves downwards in some direction that the clamped matrix hides.
TEST(BucklingStep, exact_curvature_sees_the_saddle_that_the_clamped_matrix_hides) {
  Scene scene = buckling_cloth();
  Method method = method_with(StepHessian::blend);
  NewtonSystem system(scene, method);
  Prediction prediction;
  prediction.x_tilde = scene.x0;
  prediction.c = 1;
  system.begin_step(scene.x0, prediction, dt, 1);
  system.assemble();
  double lowest = 0;
  for (int k = 0; k < 40; ++k) {
    Positions dx = Positions::Zero(3, scene.x0.cols());
    for (Eigen::Index i = 0; i < dx.cols(); ++i) {
      const double x = scene.rest(0, i), y = scene.rest(1, i);
      dx(2, i) = std::sin((3 + k % 8) * 3.1 * x + k) * std::sin((3 + k / 8) * 3.1 * y);
    }
    system.set_direction(dx);
    const double exact = system.direction_curvature();
    const VecXd reduced = stacked(dx);
    const double clamped =
        reduced.dot(system.diagnosis().clamped().lower.selfadjointView<Eigen::Lower>() * reduced);
    EXPECT_GE(clamped, 0);
    EXPECT_LE(exact, clamped * (1 + 1e-12));
    lowest = std::min(lowest, exact);
  }
  EXPECT_LT(lowest, 0);
}

}  // namespace
}  // namespace bb::hessian_modes_test
