// The ends of the spectrum that spectra and lanczos call ok: never a neighbour of the end, whatever the start vector.
#include <gtest/gtest.h>

#include <cmath>

#include "core/linear/condition.hpp"
#include "tests/linear/systems.hpp"

namespace bb::condition_ends_test {
namespace {

/// Diagonal: the eigenvalues are the entries. Each end has one neighbour at the relative distance `gap`.
ReducedSystem with_close_neighbours(int n, double gap) {
  VecXd s(n);
  for (int i = 0; i < n; ++i) s[i] = 0.95 * std::pow(10.0, -1.5 * (1 - static_cast<double>(i) / (n - 1)));
  s[n - 1] = 1;
  s[n - 2] = 1 - gap;
  s[0] = 0.01;
  s[1] = 0.01 * (1 + gap);
  Eigen::SparseMatrix<double> a(n, n);
  for (int i = 0; i < n; ++i) a.insert(i, i) = s[i];
  return from_sparse(a);
}

TEST(ConditionEnds, ANeighbourIsNeverReportedAsOk) {
  for (const double gap : {1.2e-3, 2.5e-3, 4e-3}) {
    const ReducedSystem system = with_close_neighbours(90, gap);
    ConditionEstimator conditions;
    for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
      int n_ok = 0;
      for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const ConditionEstimate e = conditions.estimate(system, {.estimator = estimator, .seed = seed});
        EXPECT_LE(e.solves, 25 + (estimator == Estimator::spectra ? default_max_solves : 0)) << seed;
        EXPECT_LE(e.products, 40 + (estimator == Estimator::spectra ? default_max_products : 0)) << seed;
        if (e.status != ConditionStatus::ok) continue;
        ++n_ok;
        EXPECT_EQ(e.proof, ProvenEnds::both) << e.method;
        EXPECT_NEAR(e.lambda_max, 1, 1e-3)
            << "gap " << gap << " seed " << seed << " " << to_string(estimator);
        EXPECT_NEAR(e.lambda_min / 0.01, 1, 1e-3)
            << "gap " << gap << " seed " << seed << " " << to_string(estimator);
      }
      EXPECT_GE(n_ok, 58) << gap << " " << to_string(estimator);
    }
  }
}

/// One soft direction among equal ones: the Krylov space of any start has two dimensions. Spectra calls pairs of it converged
/// whose vectors are none.
TEST(ConditionEnds, AnExhaustedKrylovSpaceIsNoPair) {
  ConditionEstimator conditions;
  int judged = 0;
  for (const double soft : {1e-6, 1e-9, 1e-12, 1e-13}) {
    for (int n = 60; n < 150; n += 3) {
      Eigen::SparseMatrix<double> a(n, n);
      for (int i = 0; i < n; ++i) a.insert(i, i) = i == n / 3 ? soft : 1;
      const ConditionEstimate e = conditions.estimate(from_sparse(a), {.estimator = Estimator::spectra});
      if (e.status != ConditionStatus::ok) continue;
      ++judged;
      EXPECT_NEAR(e.cond * soft, 1, 1e-3) << n << ' ' << soft << ' ' << e.method;
      EXPECT_LE(e.residual, 1e-3) << n << ' ' << soft;
    }
  }
  EXPECT_GE(judged, 100) << "of 120";
}

}  // namespace
}  // namespace bb::condition_ends_test
