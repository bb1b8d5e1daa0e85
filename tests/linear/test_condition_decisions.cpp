// What a condition estimate reports of itself: ok only where both ends are resolved, proven only above the rounding of a
// factor, and a residual that both eigenpairs keep to. Scenes on either side of each decision, for both ends alike.
#include <gtest/gtest.h>

#include <cmath>

#include "core/linear/lanczos.hpp"
#include "core/linear/scaled_matrix.hpp"
#include "tests/linear/scaled_spectrum.hpp"
#include "tests/linear/systems.hpp"

namespace bb::condition_decisions_test {
namespace {

constexpr std::uint64_t seed = 7;

ConditionEstimate estimate(const ReducedSystem& system, Estimator estimator,
                           Scaling scaling = Scaling::none) {
  ConditionEstimator conditions;
  return conditions.estimate(system, {.estimator = estimator, .scaling = scaling, .seed = seed});
}

/// Eigenvalues 1 and 2, and `value` along a direction that the start vector of this seed is orthogonal to.
ReducedSystem hidden_from(std::uint64_t start_seed, double value) {
  const int n = 60;
  const VecXd start = seeded_vector(n, start_seed);
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
  a.diagonal().tail(n / 2).setConstant(2);
  const int at = value < 1 ? 0 : n - 2;  // within the eigenspace of 1, or of 2
  VecXd u = VecXd::Zero(n);
  u[at] = start[at + 1];
  u[at + 1] = -start[at];
  u.normalize();
  a += (value - a(at, at)) * u * u.transpose();
  return from_dense(a);
}

/// An end that no step of Lanczos sees and that is beyond all shifts is not resolved; the other one is.
TEST(ConditionDecisions, OneUnresolvedEndIsALowerBound) {
  struct Case {
    std::uint64_t start;
    double value;
    bool ok;
  };
  // the small end starts from the next seed; shifts go to a tenth of what was found, or to 1.9 times it
  int bounds = 0;
  for (const Case c : {Case{seed + 1, 0.05, false}, Case{seed + 1, 0.09, false}, Case{seed + 1, 0.15, false},
                       Case{seed + 1, 0.9, true}, Case{seed + 1, 0.5, true}, Case{seed, 4.5, false},
                       Case{seed, 4.0, false}, Case{seed, 3.7, true}, Case{seed, 3.0, true}}) {
    const double cond = std::max(2.0, c.value) / std::min(1.0, c.value);
    const ConditionEstimate e = estimate(hidden_from(c.start, c.value), Estimator::lanczos);
    EXPECT_EQ(e.status, c.ok ? ConditionStatus::ok : ConditionStatus::lower_bound) << c.value << e.method;
    EXPECT_LE(e.cond, cond * (1 + (c.ok ? 1e-3 : 1e-12)))
        << c.value;  // a bound is never above what it bounds
    EXPECT_GE(e.cond, 2 - 1e-9);
    if (c.ok) {
      EXPECT_NEAR(e.cond / cond, 1, 1e-3) << c.value;
    }
    bounds += e.status == ConditionStatus::lower_bound;
  }
  EXPECT_EQ(bounds, 5);
}

TEST(ConditionDecisions, StatusIsThatOfTheWorseEnd) {
  for (const bool resolved : {false, true}) {
    ConditionEstimate e;
    e.lambda_min = 0.5, e.lambda_max = 8;
    classify(e, resolved);
    EXPECT_EQ(e.cond, 16);
    EXPECT_EQ(e.status, resolved ? ConditionStatus::ok : ConditionStatus::lower_bound);
    e.lambda_max = 0.51e14;
    classify(e, resolved);
    EXPECT_EQ(e.cond, 1e14);
    EXPECT_EQ(e.status, ConditionStatus::lower_bound);
    e.lambda_max = 0.49e14;
    classify(e, resolved);
    EXPECT_EQ(e.status, resolved ? ConditionStatus::ok : ConditionStatus::lower_bound);
    for (const auto& [smallest, status] :
         {std::pair{1e-17, ConditionStatus::singular}, std::pair{-1e-15, ConditionStatus::singular},
          std::pair{-1e-13, ConditionStatus::not_pd}}) {
      e.lambda_min = smallest, e.lambda_max = 1;
      classify(e, resolved);
      EXPECT_EQ(e.status, status) << smallest;
      EXPECT_TRUE(std::isnan(e.cond));
    }
  }
}

/// Above 0 on the side of `value`, dense enough that Lanczos does not resolve it; or alone.
VecXd with_small_end(double smallest, bool crowded) {
  VecXd s = VecXd::Ones(100);
  for (int i = 0; i < 90; ++i) s[i] = crowded ? smallest * (1 + 0.02 * i) : smallest * std::pow(4.0, i + 1);
  if (!crowded) s = s.cwiseMin(1);
  s[0] = smallest;
  return s;
}

/// The shift that proves an end is 8e-4 of it, and has to be above 1e-13 of the largest eigenvalue.
TEST(ConditionDecisions, AnEndIsProvenOnlyAboveTheRoundingOfItsFactor) {
  int shifted = 0, proven = 0, unproven = 0;
  for (const bool crowded : {false, true}) {
    for (const double smallest : {1e-6, 2.5e-10, 1.3e-10, 1.2e-10, 5e-11, 1e-11}) {
      const ReducedSystem system = from_sparse(sparse_with_spectrum(with_small_end(smallest, crowded), 3));
      for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
        const ConditionEstimate e = estimate(system, estimator);
        const bool smallest_proven = e.proof == ProvenEnds::both || e.proof == ProvenEnds::smallest;
        EXPECT_EQ(smallest_proven, smallest > 1.25e-10) << smallest << " " << e.method << " " << crowded;
        EXPECT_TRUE(e.proof == ProvenEnds::both || e.proof == ProvenEnds::largest) << smallest << e.method;
        ++(smallest_proven ? proven : unproven);
        shifted += e.method.find("smallest shifted to") != std::string::npos && !smallest_proven;
      }
    }
  }
  EXPECT_GE(shifted, 3);
  EXPECT_EQ(proven, 12);
  EXPECT_EQ(unproven, 12);
}

/// Kato and Temple: a Rayleigh quotient between two eigenvalues is no nearer to them than its residual allows.
double least_residual(double quotient, const VecXd& values) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < values.size(); ++i) least = std::min(least, std::abs(values[i] - quotient));
  double product = least * least;
  for (Eigen::Index i = 0; i + 1 < values.size(); ++i) {
    const double below = quotient - values[i], above = values[i + 1] - quotient;
    if (below >= 0 && above >= 0) product = below * above;
  }
  return std::sqrt(product);
}

/// One end is far from all others and found to the last digit; the other one is crowded.
TEST(ConditionDecisions, TheResidualIsThatOfTheWorsePair) {
  int judged = 0;
  for (const bool crowded_below : {false, true}) {
    VecXd s = VecXd::LinSpaced(120, 1, 2);
    if (crowded_below) {
      s[119] = 1000;
    } else {
      s[0] = 1e-3;
    }
    const ReducedSystem system = from_sparse(sparse_with_spectrum(s, 5));
    const VecXd values = test::eigenvalues(dense(system));
    for (const Estimator estimator : {Estimator::spectra, Estimator::lanczos}) {
      const ConditionEstimate e = estimate(system, estimator);
      const double at_small = least_residual(e.lambda_min, values),
                   at_large = least_residual(e.lambda_max, values);
      EXPECT_GE(e.residual * e.lambda_max * (1 + 1e-3), std::max(at_small, at_large))
          << to_string(estimator) << crowded_below;
      EXPECT_LE(e.residual, 1e-2);
      const double crowded = crowded_below ? at_small : at_large, alone = crowded_below ? at_large : at_small;
      EXPECT_GT(crowded, 1e-7) << to_string(estimator) << " " << crowded_below;
      EXPECT_GT(crowded, alone) << to_string(estimator) << " " << crowded_below;
      ++judged;
    }
  }
  EXPECT_EQ(judged, 4);
}

/// Every pair that was queried counts, in any order and scaling, by |B v - lambda v| of the dense matrix.
TEST(ConditionDecisions, ResidualsAreRaisedAndNeverLowered) {
  const ReducedSystem system = grid_system(4, 0.3);
  const Eigen::MatrixXd a = dense(system);
  int raised = 0, kept = 0;
  for (const Scaling kind : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
    FactoredMatrix matrix;
    matrix.system = &system;
    matrix.product.update(system);
    BlockScaling scaling;
    ASSERT_EQ(scaling.setup(system, kind), LinearStatus::ok);
    ConditionEstimate counts;
    ScaledMatrix b(matrix, scaling, counts);
    double largest = 0;
    for (unsigned k = 1; k <= 12; ++k) {
      const VecXd v = (k % 3 + 0.5) * random_vector(b.n(), k);
      VecXd image = v;
      scaling.solve_upper(image);
      image = a * image;
      scaling.solve_lower(image);
      const double lambda = v.dot(image) / v.squaredNorm();
      const double residual = (image - lambda * v).norm() / v.norm();
      ASSERT_GT(residual, 0.1);
      EXPECT_NEAR(b.rayleigh(v), lambda, 1e-11 * lambda);
      ++(residual > largest ? raised : kept);
      largest = std::max(largest, residual);
      EXPECT_NEAR(counts.residual, largest, 1e-10 * largest) << k;
      EXPECT_EQ(counts.products, static_cast<int>(k));
    }
  }
  EXPECT_GE(raised, 6);
  EXPECT_GE(kept, 6);
}

}  // namespace
}  // namespace bb::condition_decisions_test
