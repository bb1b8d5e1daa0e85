// The status words of the condition estimates, and what comes with them.
#include <gtest/gtest.h>

#include "core/linear/condition.hpp"
#include "core/math/error.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::condition_status_test {
namespace {

ConditionEstimate estimate(const ReducedSystem& system, Estimator estimator,
                           Scaling scaling = Scaling::none) {
  ConditionEstimator conditions;
  return conditions.estimate(system, {estimator, scaling, 1});
}

/// A path graph's Laplacian: integers, exactly singular.
ReducedSystem laplacian(int n) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i + 1 < n; ++i) a.block<2, 2>(i, i) += (Eigen::Matrix2d() << 1, -1, -1, 1).finished();
  return from_dense(a);
}

TEST(ConditionStatus, SingularMatrixIsNamed) {
  VecXd s = spectrum("geometric", 120, 1e3);
  s.head(6).setZero();
  for (const Estimator estimator :
       {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
    for (const ReducedSystem& system : {laplacian(40), from_dense(with_spectrum(s, 2))}) {
      const ConditionEstimate e = estimate(system, estimator);
      EXPECT_EQ(e.status, ConditionStatus::singular) << to_string(estimator) << " min " << e.lambda_min;
      EXPECT_TRUE(std::isnan(e.cond));
      EXPECT_LT(std::abs(e.lambda_min), 1e-14 * e.lambda_max);
      EXPECT_GT(e.lambda_max, 0.5);
    }
  }
}

TEST(ConditionStatus, IndefiniteMatrixIsNotPd) {
  for (const double negative : {-0.3, -1e-5, -1e-9, -1e-11}) {
    VecXd s = spectrum("geometric", 90, 1e3);
    s[0] = negative;
    for (const Estimator estimator :
         {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
      const ConditionEstimate e = estimate(from_dense(with_spectrum(s, 2)), estimator);
      EXPECT_EQ(e.status, ConditionStatus::not_pd) << to_string(estimator) << " " << negative;
      EXPECT_TRUE(std::isnan(e.cond));
      if (negative > -1e-8 || estimator == Estimator::dense) {
        EXPECT_NEAR(e.lambda_min / negative, 1, 1e-3) << to_string(estimator);
      }
      if (negative > -1e-8 && estimator != Estimator::dense) {
        EXPECT_NE(e.method.find("sigma = -1e-8"), std::string::npos);
      }
    }
  }
}

TEST(ConditionStatus, NegativeDiagonalIsNotPdInEveryScaling) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(9, 9);
  a(4, 4) = -1;
  for (const Estimator estimator :
       {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
    for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
      EXPECT_EQ(estimate(from_dense(a), estimator, scaling).status, ConditionStatus::not_pd);
    }
  }
}

TEST(ConditionStatus, Above1e14IsALowerBound) {
  for (const int n : {30, 120}) {
    const ReducedSystem system = from_dense(with_spectrum(spectrum("geometric", n, 1e15), 2));
    for (const Estimator estimator :
         {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
      const ConditionEstimate e = estimate(system, estimator);
      EXPECT_EQ(e.status, ConditionStatus::lower_bound) << to_string(estimator) << " min " << e.lambda_min;
      EXPECT_EQ(e.cond, 1e14);
      EXPECT_LT(e.lambda_min, 1e-14);
    }
  }
}

TEST(ConditionStatus, EmptyRowIsSingular) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(6, 6);
  a(2, 2) = 0;  // not even stored
  for (const Estimator estimator :
       {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
    EXPECT_EQ(estimate(from_dense(a), estimator).status, ConditionStatus::singular) << to_string(estimator);
  }
}

TEST(ConditionStatus, SmallSystemsAreExact) {
  for (const Estimator estimator :
       {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
    const ConditionEstimate one = estimate(from_dense(Eigen::MatrixXd::Constant(1, 1, 4.0)), estimator);
    EXPECT_EQ(one.cond, 1) << to_string(estimator);
    EXPECT_NEAR(one.lambda_min, 4, 1e-11) << to_string(estimator);
    const ConditionEstimate two = estimate(from_dense(Eigen::Vector2d(1, 100).asDiagonal()), estimator);
    EXPECT_NEAR(two.cond, 100, estimator == Estimator::inverse_power ? 1e-6 : 1e-10) << to_string(estimator);
  }
}

TEST(ConditionStatus, NonFiniteEmptyAndTooLargeAreNotConverged) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(6, 6);
  a(3, 3) = std::numeric_limits<double>::infinity();
  for (const Estimator estimator :
       {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
    EXPECT_EQ(estimate(from_dense(a), estimator).status, ConditionStatus::not_converged);
    EXPECT_EQ(estimate(from_dense(Eigen::MatrixXd(0, 0)), estimator).status, ConditionStatus::not_converged);
  }
  Eigen::SparseMatrix<double> large(3001, 3001);
  large.setIdentity();
  EXPECT_EQ(estimate(from_sparse(large), Estimator::dense).status, ConditionStatus::not_converged);
  EXPECT_EQ(estimate(from_sparse(large), Estimator::spectra).status, ConditionStatus::ok);
  EXPECT_THROW(estimate(from_dense(a), Estimator::ritz), ConfigError);
}

TEST(ConditionStatus, RitzValuesAreALowerBound) {
  const ConditionEstimate e = condition_from_ritz(0.5, 8);
  EXPECT_EQ(e.status, ConditionStatus::lower_bound);
  EXPECT_EQ(e.cond, 16);
  EXPECT_EQ(e.method, "ritz");
  EXPECT_EQ(condition_from_ritz(0, 0).status, ConditionStatus::not_converged);
  EXPECT_TRUE(std::isnan(condition_from_ritz(0, 0).cond));
  EXPECT_EQ(condition_from_ritz(1e-15, 1).cond, 1e14);
}

TEST(ConditionStatus, TheSameEstimatorServesChangingMatrices) {
  ConditionEstimator conditions;
  for (const double diagonal : {1.0, 1e-2, 1.0}) {
    for (const int m : {6, 9}) {
      const ReducedSystem system = grid_system(m, diagonal, static_cast<std::uint64_t>(m));
      const VecXd truth = test::eigenvalues(dense(system));
      const ConditionEstimate e = conditions.estimate(system, {Estimator::spectra, Scaling::none, 1});
      EXPECT_NEAR(e.cond / (truth[truth.size() - 1] / truth[0]), 1, 1e-3) << m << " " << diagonal;
    }
  }
}

}  // namespace
}  // namespace bb::condition_status_test
