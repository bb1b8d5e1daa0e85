// Condition estimates on matrices whose spectrum is known by construction.
#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>

#include "core/linear/condition.hpp"
#include "core/linear/spectra_end.hpp"
#include "tests/linear/scaled_spectrum.hpp"
#include "tests/linear/systems.hpp"

namespace bb::condition_test {
namespace {

ConditionEstimate estimate(const ReducedSystem& system, Estimator estimator, Scaling scaling = Scaling::none,
                           std::uint64_t seed = 1) {
  ConditionEstimator conditions;
  return conditions.estimate(system, {estimator, scaling, seed});
}

void print_row(const std::string& kind, int n, double cond, const ConditionEstimate& e) {
  std::printf(
      "%-18s %5d %8.0e  cond/truth - 1 %9.1e  min %9.1e  max %9.1e  %-11s solves %2d products %2d "
      "factors +%d residual %.0e  %.3f s\n",
      kind.c_str(), n, cond, e.cond / cond - 1, e.lambda_min * cond - 1, e.lambda_max - 1,
      std::string(to_string(e.status)).c_str(), e.solves, e.products, e.factorizations, e.residual,
      e.seconds);
}

void expect_close(const ConditionEstimate& e, double cond, const std::string& what) {
  const double tol = cond > 1e10 ? 1e-2 : 1e-3;
  EXPECT_EQ(e.status, ConditionStatus::ok) << what;
  EXPECT_NEAR(e.cond / cond, 1, tol) << what;
  EXPECT_NEAR(e.lambda_min * cond, 1, tol) << what;
  EXPECT_NEAR(e.lambda_max, 1, tol) << what;
}

/// spectra: what Spectra may take, and then lanczos.
void expect_budget(Estimator estimator, const ConditionEstimate& e, const std::string& what) {
  EXPECT_LE(e.solves, 25 + (estimator == Estimator::spectra ? default_max_solves : 0)) << what;
  EXPECT_LE(e.products, 40 + (estimator == Estimator::spectra ? default_max_products : 0)) << what;
  EXPECT_GT(e.products, 0) << what;
}

TEST(Condition, SpectraDenseAndLanczosMeetKnownSpectraWhenDense) {
  for (const int n : {30, 100, 300}) {
    for (const double cond : {1e1, 1e3, 1e6, 1e10, 1e12}) {
      for (const std::string& kind : spectrum_kinds()) {
        const ReducedSystem system = from_dense(with_spectrum(spectrum(kind, n, cond), 3));
        const std::string what = kind + " n " + std::to_string(n) + " cond " + std::to_string(cond);
        for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
          const ConditionEstimate e = estimate(system, estimator);
          print_row(kind, n, cond, e);
          expect_close(e, cond, what + " " + std::string(to_string(estimator)));
          expect_budget(estimator, e, what);
        }
        if (n <= 100) expect_close(estimate(system, Estimator::dense), cond, what + " dense");
      }
    }
  }
}

TEST(Condition, SpectraAndLanczosMeetKnownSpectraWhenLargeAndSparse) {
  // The factor of such a matrix is nearly dense, so the largest one comes with one condition number only.
  for (const auto& [n, cond] : {std::pair{1200, 1e2}, {1200, 1e6}, {3000, 1e10}, {1200, 1e12}}) {
    for (const std::string& kind : spectrum_kinds()) {
      const ReducedSystem system = from_sparse(sparse_with_spectrum(spectrum(kind, n, cond), 3));
      for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
        const ConditionEstimate e = estimate(system, estimator);
        print_row(kind, n, cond, e);
        expect_close(e, cond, kind + " " + std::to_string(cond) + " " + std::string(to_string(estimator)));
        expect_budget(estimator, e, kind);
      }
    }
  }
}

TEST(Condition, SpectraAndLanczosHoldForOtherSeeds) {
  std::vector<std::uint64_t> seeds(38);
  std::iota(seeds.begin(), seeds.end(), 2);
  seeds.push_back(892);  // starts almost at a right angle to the wanted eigenvector of "geometric"
  for (const std::uint64_t seed : seeds) {
    for (const std::string& kind : spectrum_kinds()) {
      const ReducedSystem system = from_dense(with_spectrum(spectrum(kind, 90, 1e4), 4));
      for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
        const ConditionEstimate e = estimate(system, estimator, Scaling::none, seed);
        expect_close(e, 1e4,
                     kind + " seed " + std::to_string(seed) + " " + std::string(to_string(estimator)));
        expect_budget(estimator, e, kind);
      }
    }
  }
}

TEST(Condition, InversePowerIsALowerBoundWithinAFewPercentOrWorse) {
  double worst = 1;
  for (const int n : {30, 300}) {
    for (const double cond : {1e1, 1e4, 1e8, 1e12}) {
      for (const std::string& kind : spectrum_kinds()) {
        const ReducedSystem system = from_dense(with_spectrum(spectrum(kind, n, cond), 6));
        const ConditionEstimate e = estimate(system, Estimator::inverse_power);
        // The truth itself moves by the rounding of the entries: eps |A| against lambda_min.
        const double slack = 1e-10 + 1e-16 * cond;
        EXPECT_EQ(e.status, ConditionStatus::lower_bound) << kind;
        EXPECT_LE(e.cond / cond, 1 + slack) << kind << " " << n << " " << cond;
        EXPECT_LE(e.lambda_max, 1 + 1e-10) << kind;
        EXPECT_GE(e.lambda_min * cond, 1 - slack) << kind;
        EXPECT_EQ(e.solves, 4);
        EXPECT_LE(e.products, 21);
        worst = std::min(worst, e.cond / cond);
      }
    }
  }
  std::printf("inverse_power: smallest cond / truth %.3f\n", worst);
  EXPECT_GT(worst, 0.5);
  EXPECT_LT(worst, 0.9999);  // it is a bound, not the value: the test has something to bound
}

TEST(Condition, ScalingsMeetDenseAlgebra) {
  Eigen::MatrixXd a = with_spectrum(spectrum("geometric", 100, 1e5), 8);
  VecXd rows =
      VecXd::NullaryExpr(100, [](Eigen::Index i) { return std::pow(10.0, static_cast<double>(i % 7)); });
  a = (rows.asDiagonal() * a * rows.asDiagonal()).eval();
  const ReducedSystem system = from_dense(a);  // 100 = 33 blocks of 3 and one of 1
  ConditionEstimator conditions;
  std::vector<double> truths;
  for (const Estimator estimator : {Estimator::spectra, Estimator::dense}) {
    for (const Scaling scaling : {Scaling::jacobi, Scaling::block_jacobi}) {
      const VecXd truth = test::scaled_spectrum(system, scaling);
      const double cond = truth[99] / truth[0];
      const ConditionEstimate e = conditions.estimate(system, {estimator, scaling, 1});
      EXPECT_EQ(e.status, ConditionStatus::ok);
      EXPECT_NEAR(e.cond / cond, 1, 1e-3) << to_string(scaling) << " " << to_string(estimator);
      EXPECT_NEAR(e.lambda_min / truth[0], 1, 1e-3);
      EXPECT_NEAR(e.lambda_max / truth[99], 1, 1e-3);
      truths.push_back(cond);
    }
  }
  const double unscaled =
      test::scaled_spectrum(system, Scaling::none)[99] / test::scaled_spectrum(system, Scaling::none)[0];
  EXPECT_GT(unscaled, 10 * truths[0]);                   // the scalings do something
  EXPECT_GT(std::abs(truths[0] / truths[1] - 1), 0.01);  // and not the same
}

TEST(Condition, AnEstimatorThatHasSeenTheMatrixSaysTheSame) {
  const ReducedSystem system = grid_system(12, 1e-3, 42);
  ConditionEstimator conditions;
  for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
    const ConditionEstimate again = conditions.estimate(system, {Estimator::spectra, scaling, 7}),
                            one = estimate(system, Estimator::spectra, scaling, 7);
    const VecXd truth = test::scaled_spectrum(system, scaling);
    EXPECT_EQ(again.lambda_min, one.lambda_min);
    EXPECT_EQ(again.lambda_max, one.lambda_max);
    EXPECT_NEAR(again.cond / (truth[truth.size() - 1] / truth[0]), 1, 1e-3) << to_string(scaling);
    EXPECT_LT(again.residual, 1e-2);
    print_row("grid " + std::string(to_string(scaling)), 432, truth[truth.size() - 1] / truth[0], again);
  }
}

TEST(Condition, LargestEigenvalueAgreesWithSpectra) {
  const ReducedSystem system = grid_system(20, 1e-2, 1);
  const auto product = [&](const VecXd& x, VecXd& out) {
    out = system.lower.selfadjointView<Eigen::Lower>() * x;
  };
  const SpectraEnd spectra =
      spectra_largest(product, VecXd::LinSpaced(system.lower.rows(), -1, 2), 20000, 1e-10);
  ASSERT_TRUE(spectra.converged);
  const ConditionEstimate e = estimate(system, Estimator::lanczos);  // ours
  EXPECT_EQ(e.status, ConditionStatus::ok);
  EXPECT_NEAR(e.lambda_max / spectra.value, 1, 1e-3);
}

}  // namespace
}  // namespace bb::condition_test
