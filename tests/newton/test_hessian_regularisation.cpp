// How far from the exact Hessian an attempt is, and what it makes of the elements of a family.
#include "core/newton/hessian_regularisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace bb::hessian_regularisation_test {
namespace {

constexpr double residual = 8;  // N

/// Two springs, 0-1 and 1-2, their Hessians full of ones and twos when exact, tens when clamped.
struct Springs {
  std::vector<int> vertices{0, 1, 1, 2};
  TermFamily family;
  std::vector<double> force{0, 1, residual}, buffer;

  Springs() {
    family.stencils = {2, vertices};
    family.local.hess.assign(54, 1);
    std::fill(family.local.hess.begin() + 27, family.local.hess.end(), 2);
    family.clamped.hess.assign(54, 10);
  }
  double entry(StepHessian choice, const HessianRegularisation& level, std::size_t element) {
    const LocalHessians hess = hessian_at(family, choice, level, force, buffer);
    const std::size_t i = 27 * element + 5;
    return hess.to.empty() ? hess.from[i] : std::lerp(hess.from[i], hess.to[i], hess.t);
  }
};

TEST(HessianRegularisation, of_clamped_and_absolute_terms_never_changes) {
  for (const StepHessian choice : {StepHessian::clamped, StepHessian::absolute}) {
    const HessianRegularisation level({choice, choice});
    EXPECT_TRUE(level.exact() && level.last());
    EXPECT_EQ(level.all_clamped(), choice == StepHessian::clamped);
    EXPECT_EQ(Springs().entry(choice, level, 1), 2);
  }
}

TEST(HessianRegularisation, blend_goes_to_the_clamped_matrix_in_four_attempts_and_back_in_as_many) {
  HessianRegularisation level({StepHessian::clamped, StepHessian::blend});
  Springs springs;
  EXPECT_EQ(springs.entry(StepHessian::blend, level, 0), 1);
  for (const double t : {0.125, 0.25, 0.5, 1.0}) {
    ASSERT_FALSE(level.last());
    level.raise(residual);
    EXPECT_EQ(level.t(), t);
    EXPECT_DOUBLE_EQ(springs.entry(StepHessian::blend, level, 0), 1 + 9 * t);
    EXPECT_DOUBLE_EQ(springs.entry(StepHessian::blend, level, 1), 2 + 8 * t);
  }
  EXPECT_TRUE(level.last() && level.all_clamped());
  for (const double t : {0.5, 0.25, 0.125, 0.0, 0.0}) {
    level.lower(residual);
    EXPECT_EQ(level.t(), t);
  }
  EXPECT_TRUE(level.exact());
}

TEST(HessianRegularisation, exact_or_clamped_has_two_levels) {
  HessianRegularisation level({StepHessian::exact_or_clamped});
  Springs springs;
  EXPECT_EQ(springs.entry(StepHessian::exact_or_clamped, level, 0), 1);
  level.raise(residual);
  EXPECT_TRUE(level.last());
  EXPECT_EQ(springs.entry(StepHessian::exact_or_clamped, level, 0), 10);
  level.lower(residual);
  EXPECT_TRUE(level.exact());
}

TEST(HessianRegularisation, progressive_clamps_where_the_force_is_large_first) {
  HessianRegularisation level({StepHessian::progressive});
  Springs springs;
  EXPECT_EQ(springs.entry(StepHessian::progressive, level, 1), 2);
  level.raise(residual);
  EXPECT_EQ(level.threshold(), residual / 2);
  EXPECT_EQ(springs.entry(StepHessian::progressive, level, 0), 1);
  EXPECT_EQ(springs.entry(StepHessian::progressive, level, 1), 10);  // its vertex 2 has the largest force
  int attempts = 1;
  for (; !level.last(); ++attempts) level.raise(residual);
  EXPECT_EQ(level.threshold(), 0);
  EXPECT_EQ(springs.entry(StepHessian::progressive, level, 0), 10);
  EXPECT_LT(attempts, 12);
  for (int i = 0; i < 12 && !level.exact(); ++i) level.lower(residual);
  EXPECT_TRUE(level.exact());
}

TEST(HessianRegularisation, a_mixture_ends_when_all_are_clamped_and_begins_anew_with_a_step) {
  HessianRegularisation level({StepHessian::progressive, StepHessian::blend});
  for (int i = 0; i < 4; ++i) level.raise(residual);
  EXPECT_EQ(level.t(), 1);
  EXPECT_FALSE(level.last());  // some elements of progressive are exact
  while (!level.last()) level.raise(residual);
  EXPECT_TRUE(level.all_clamped());
  level.reset();
  EXPECT_TRUE(level.exact());
}

}  // namespace
}  // namespace bb::hessian_regularisation_test
