// Who finds the ends of the spectrum, and what the estimate reports of it: Spectra in its budget, our Lanczos beyond it or on
// its own, and the proof of each end.
#include <gtest/gtest.h>

#include <cmath>

#include "core/linear/condition.hpp"
#include "core/linear/spectra_end.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::condition_methods_test {
namespace {

constexpr Scaling all_scalings[] = {Scaling::none, Scaling::jacobi, Scaling::block_jacobi};

ConditionEstimate estimate(const ReducedSystem& system, const ConditionOptions& options) {
  ConditionEstimator conditions;
  return conditions.estimate(system, options);
}

double true_cond(const ReducedSystem& system) {
  const VecXd values = test::eigenvalues(dense(system));
  return values[values.size() - 1] / values[0];
}

TEST(ConditionMethods, SpectraAndLanczosEachSayWhoTheyAre) {
  const ReducedSystem system = grid_system(10, 1e-2);
  for (const Scaling scaling : all_scalings) {
    const ConditionEstimate by_spectra =
        estimate(system, {.estimator = Estimator::spectra, .scaling = scaling});
    const ConditionEstimate by_lanczos =
        estimate(system, {.estimator = Estimator::lanczos, .scaling = scaling});
    const ConditionEstimate truth = estimate(system, {.estimator = Estimator::dense, .scaling = scaling});
    EXPECT_EQ(by_spectra.method, "spectra");
    EXPECT_EQ(by_lanczos.method.substr(0, 7), "lanczos");
    for (const ConditionEstimate& e : {by_spectra, by_lanczos}) {
      EXPECT_EQ(e.status, ConditionStatus::ok);
      EXPECT_EQ(e.proof, ProvenEnds::both);
      EXPECT_GE(e.factorizations, 2);
      EXPECT_NEAR(e.cond / truth.cond, 1, 1e-3);
    }
    EXPECT_GT(by_spectra.solves, 2);
    EXPECT_LE(by_spectra.solves, default_max_solves + 1);
    EXPECT_LE(by_spectra.products, default_max_products + 2);
    EXPECT_LE(by_lanczos.solves, 25);
    EXPECT_LE(by_lanczos.products, 40);
  }
}

TEST(ConditionMethods, LanczosTakesOverBeyondTheBudgetAndSaysForWhichEnd) {
  const ReducedSystem system = grid_system(10, 1e-2);
  const double cond = true_cond(system);
  const auto has = [](const ConditionEstimate& e, const char* words) {
    return e.method.find(words) != std::string::npos;
  };
  const ConditionEstimate both = estimate(system, {.max_solves = 9, .max_products = 19});
  EXPECT_TRUE(has(both, "spectra") && has(both, "smallest by lanczos") && has(both, "largest by lanczos"))
      << both.method;
  const ConditionEstimate small = estimate(system, {.max_solves = 9});
  EXPECT_TRUE(has(small, "smallest by lanczos") && !has(small, "largest by lanczos")) << small.method;
  const ConditionEstimate large = estimate(system, {.max_products = 19});
  EXPECT_TRUE(has(large, "largest by lanczos") && !has(large, "smallest by lanczos")) << large.method;
  for (const ConditionEstimate& e : {both, small, large}) {
    EXPECT_EQ(e.status, ConditionStatus::ok);
    EXPECT_EQ(e.proof, ProvenEnds::both);
    EXPECT_NEAR(e.cond / cond, 1, 1e-3);
  }
  EXPECT_GT(both.solves, 9);  // what Spectra spent counts too
  EXPECT_LE(both.solves, 9 + 25);
  EXPECT_LE(both.products, 19 + 40);
}

/// Spectra compares residuals with an absolute number below 4e-11: without a scale of its own every estimate of a stiff
/// matrix would stop at once.
TEST(ConditionMethods, UnitsChangeNothing) {
  ReducedSystem system = grid_system(9, 1e-3);
  const ConditionEstimate once = estimate(system, {});
  for (const double unit : {0x1p60, 0x1p-60}) {
    ReducedSystem other = system;
    other.lower.coeffs() *= unit;
    const ConditionEstimate e = estimate(other, {});
    EXPECT_EQ(e.cond, once.cond) << unit;
    EXPECT_EQ(e.lambda_min, unit * once.lambda_min) << unit;
    EXPECT_EQ(e.solves, once.solves) << unit;
    EXPECT_EQ(e.products, once.products) << unit;
    EXPECT_EQ(e.method, once.method) << unit;
  }
  EXPECT_EQ(once.method, "spectra");
}

TEST(ConditionMethods, TheSeedDecidesTheStartAndNothingElse) {
  const ReducedSystem system = grid_system(9, 1e-3);
  const ConditionEstimate first = estimate(system, {.seed = 5}), again = estimate(system, {.seed = 5}),
                          other = estimate(system, {.seed = 6});
  EXPECT_EQ(first.lambda_min, again.lambda_min);
  EXPECT_EQ(first.lambda_max, again.lambda_max);
  EXPECT_EQ(first.residual, again.residual);
  EXPECT_NE(first.residual, other.residual);
  EXPECT_NEAR(first.cond / other.cond, 1, 1e-3);
}

/// The proof of the small end needs a shift of 8e-4 lambda_min that stands out of 1e-13 lambda_max.
TEST(ConditionMethods, ProofIsLeftOutWhereRoundingWouldDecide) {
  for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
    for (const auto& [cond, proof] :
         {std::pair{1e9, ProvenEnds::both}, std::pair{1e11, ProvenEnds::largest}}) {
      const ConditionEstimate e =
          estimate(from_dense(with_spectrum(spectrum("geometric", 90, cond), 2)), {.estimator = estimator});
      EXPECT_EQ(e.status, ConditionStatus::ok) << to_string(estimator) << " " << cond;
      EXPECT_EQ(e.proof, proof) << to_string(estimator) << " " << cond << " " << to_string(e.proof);
      EXPECT_NEAR(e.cond / cond, 1, 1e-2) << to_string(estimator);
    }
    const ConditionEstimate indefinite =
        estimate(from_dense(with_spectrum(VecXd::LinSpaced(30, -1, 1), 2)), {.estimator = estimator});
    EXPECT_EQ(indefinite.proof, ProvenEnds::none);
    EXPECT_EQ(indefinite.status, ConditionStatus::not_pd);
  }
}

TEST(ConditionMethods, EveryKnownSpectrumIsMetBySpectraAndLanczos) {
  int by_spectra = 0, n = 0;
  for (const double cond : {1e2, 1e6, 1e10}) {
    for (const std::string& kind : spectrum_kinds()) {
      const ReducedSystem system = from_dense(with_spectrum(spectrum(kind, 120, cond), 3));
      for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
        const ConditionEstimate e = estimate(system, {.estimator = estimator});
        EXPECT_EQ(e.status, ConditionStatus::ok) << kind << " " << cond;
        EXPECT_NEAR(e.cond / cond, 1, 1e-3) << kind << " " << cond << " " << e.method;
        by_spectra += e.method.substr(0, 7) == "spectra";
      }
      ++n;
    }
  }
  EXPECT_EQ(by_spectra, n);
}

TEST(SpectraEnd, StaysWithinItsApplications) {
  const VecXd values = VecXd::LinSpaced(200, 1, 2);  // dense at its end: no solver is done in 20
  int applied = 0;
  const SymmetricOperator op = [&](const VecXd& x, VecXd& y) {
    ++applied;
    y = values.cwiseProduct(x);
  };
  const VecXd start = VecXd::LinSpaced(200, -1, 1);
  for (const int most : {1, 19, 20, 35}) {
    applied = 0;
    EXPECT_FALSE(spectra_largest(op, start, most, 1e-12).converged) << most;
    EXPECT_EQ(applied, most);
  }
  applied = 0;
  const SpectraEnd end = spectra_largest(op, start, 2000, 1e-6);
  ASSERT_TRUE(end.converged);
  EXPECT_LE((values.cwiseProduct(end.vector) - end.value * end.vector).norm(), 1e-5);
  EXPECT_NEAR(end.value, 2, 1e-6);
  EXPECT_NEAR(end.vector.norm(), 1, 1e-12);
  const SpectraEnd inverted = spectra_smallest_inverted(
      [&](const VecXd& x, VecXd& y) { y = x.cwiseQuotient(values); }, start, 2000, 1e-6);
  ASSERT_TRUE(inverted.converged);
  EXPECT_NEAR(inverted.value, 1, 1e-6);
}

TEST(SpectraEnd, NumbersThatAreNotFiniteAndSpacesThatAreTooSmallAreNotConverged) {
  const double nan = std::nan("");
  EXPECT_FALSE(
      spectra_largest([&](const VecXd& x, VecXd& y) { y = nan * x; }, VecXd::Ones(30), 100, 1e-3).converged);
  EXPECT_FALSE(
      spectra_largest([](const VecXd& x, VecXd& y) { y = 0 * x; }, VecXd::Ones(30), 100, 1e-3).converged);
  EXPECT_FALSE(spectra_largest([](const VecXd& x, VecXd& y) { y = x; }, VecXd::Ones(1), 100, 1e-3).converged);
  EXPECT_TRUE(
      spectra_largest([](const VecXd& x, VecXd& y) { y = 3 * x; }, VecXd::Ones(2), 100, 1e-3).converged);
}

}  // namespace
}  // namespace bb::condition_methods_test
