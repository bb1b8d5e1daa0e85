// Strain limit of a whole mesh: columns, terms, step bound over elements, kappa policies.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "core/energy/strain_limit_batch.hpp"
#include "core/math/error.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/strain_shapes.hpp"
#include "tests/energy/strip.hpp"

namespace bb::test::strain_limit_batch_test {
namespace {

const BatchOf<LogStandIn> barrier;

StrainLimitBatch make_batch(const Strip& strip, double onset, double width, bool planar = false) {
  const std::size_t n = strip.triangles.size();
  return StrainLimitBatch(strip.triangles, strip.rest, std::vector<double>(n, onset),
                          std::vector<double>(n, width), planar);
}

TEST(StrainLimitBatch, ColumnsAndTermsAreThoseOfTheElements) {
  const Strip strip(50);
  for (const bool planar : {false, true}) {
    StrainLimitBatch batch = make_batch(strip, 0.1, 0.9, planar);
    std::vector<double> kappa(batch.size()), energy(batch.size());
    for (std::size_t e = 0; e < kappa.size(); ++e) kappa[e] = 5 * batch.rests()[e].area;
    LocalTerms out;
    batch.derivatives(strip.deformed, barrier, kappa.data(), Projection::psd, out);
    batch.values(strip.deformed, barrier, kappa.data(), energy.data());
    EXPECT_GT(batch.n_active(), 5u);
    EXPECT_LT(batch.n_active(), batch.size());
    EXPECT_GT(batch.min_gap(), 0);
    EXPECT_NEAR(batch.min_gap(), 0.9 - (batch.max_stretch() - 0.1), 1e-15);

    double gradient_norm = 0;
    for (std::size_t e = 0; e < batch.size(); ++e) {
      const double expected = kappa[e] * (LogStandIn{}(batch.gaps()[2 * e], 0.9).b +
                                          LogStandIn{}(batch.gaps()[2 * e + 1], 0.9).b);
      EXPECT_NEAR(energy[e], expected, 1e-15);
      EXPECT_NEAR(out.energy[e], expected, 1e-15);
      const bool active = batch.sigma()[2 * e] > 1.1;
      double norm = 0;
      for (std::size_t i = 0; i < 9; ++i) norm += std::abs(out.grad[9 * e + i]);
      EXPECT_EQ(active, norm > 0) << e;
      gradient_norm += norm;
    }
    EXPECT_GT(gradient_norm, 0);
  }
}

TEST(StrainLimitBatch, AStateThatWasMeasuredLastIsKnown) {
  const Strip strip(10);
  StrainLimitBatch batch = make_batch(strip, 0.1, 0.9), fresh = make_batch(strip, 0.1, 0.9);
  const std::vector<double> kappa(batch.size(), 2.0);
  std::vector<double> energy(batch.size());
  LocalTerms out;
  batch.values(strip.deformed, barrier, kappa.data(), energy.data());
  batch.derivatives(strip.deformed, barrier, kappa.data(), Projection::psd, out);
  batch.measure(strip.deformed);
  EXPECT_EQ(batch.sweeps(), 1);
  Positions other = strip.deformed;
  other(0, other.cols() - 1) += 0.01;
  batch.measure(other);
  fresh.measure(other);
  EXPECT_EQ(batch.sweeps(), 2);
  for (std::size_t i = 0; i < 2 * batch.size(); ++i) EXPECT_EQ(batch.sigma()[i], fresh.sigma()[i]) << i;
}

TEST(StrainLimitBatch, GradientIsTheDerivativeOfTheSum) {
  const Strip strip(10);
  StrainLimitBatch batch = make_batch(strip, 0.1, 0.9);
  std::vector<double> kappa(batch.size(), 2.0), energy(batch.size());
  LocalTerms out;
  batch.derivatives(strip.deformed, barrier, kappa.data(), Projection::psd, out);
  Positions gradient = Positions::Zero(3, strip.rest.cols());
  for (std::size_t slot = 0; slot < batch.vertices().size(); ++slot) {
    for (int a = 0; a < 3; ++a)
      gradient(a, batch.vertices()[slot]) += out.grad[3 * slot + static_cast<std::size_t>(a)];
  }
  const auto total = [&](const Positions& x) {
    batch.values(x, barrier, kappa.data(), energy.data());
    double sum = 0;
    for (const double value : energy) sum += value;
    return sum;
  };
  const Positions direction = Positions::Random(3, strip.rest.cols());
  const double exact = gradient.cwiseProduct(direction).sum();
  double best = 1;
  for (double h = 1e-3; h > 1e-7; h /= 10) {
    const double slope =
        (total(strip.deformed + h * direction) - total(strip.deformed - h * direction)) / (2 * h);
    best = std::min(best, std::abs(slope - exact) / std::abs(exact));
  }
  EXPECT_GT(std::abs(exact), 1e-3);
  EXPECT_LT(best, 1e-7);
}

TEST(StrainLimitBatch, InfiniteBeyondTheLimit) {
  const Strip strip(10);
  StrainLimitBatch batch = make_batch(strip, 0.0, 0.05);
  std::vector<double> kappa(batch.size(), 2.0), energy(batch.size());
  batch.values(strip.deformed, barrier, kappa.data(), energy.data());
  EXPECT_LT(batch.min_gap(), 0);
  EXPECT_EQ(*std::max_element(energy.begin(), energy.end()), std::numeric_limits<double>::infinity());
}

TEST(StrainLimitBatch, StepBoundIsTheLastFeasibleNumberOfTheWholeMesh) {
  const Strip strip(60);
  for (const bool planar : {false, true}) {
    StrainLimitBatch batch = make_batch(strip, 0.02, 0.1, planar);
    const Positions dx = 3 * (strip.deformed - strip.rest);
    const double alpha = batch.step_bound(strip.rest, dx);
    ASSERT_GT(alpha, 0);
    ASSERT_LT(alpha, 1);
    batch.measure(Positions(strip.rest + alpha * dx));
    EXPECT_GT(batch.min_gap(), 0);
    batch.measure(Positions(strip.rest + std::nextafter(alpha, 1.0) * dx));
    EXPECT_LE(batch.min_gap(), 0);
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(batch.step_bound(strip.rest, dx), alpha);
    EXPECT_EQ(batch.step_bound(strip.rest, dx, alpha / 2), alpha / 2);
    EXPECT_EQ(batch.step_bound(strip.rest, Positions(1e-3 * dx)), 1);
  }
}

/// Triangles of one shape, each turned and moved its own way, that one motion stretches alike: their bounds are one number but
/// for roundings, and at that of one another may be beyond its limit by a rounding.
TEST(StrainLimitBatch, StepBoundIsWithinTheLimitOfEveryElementOfEqualStretch) {
  constexpr int n = 24;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<std::array<int, 3>> triangles;
    Positions rest(3, 3 * n), dx(3, 3 * n);
    for (int e = 0; e < n; ++e) {
      const Mat3d turn = random_rotation(random);
      const Vec3d place(any(random), any(random), any(random));
      const Vec3d corner[] = {Vec3d(0, 0, 0), Vec3d(0.1, 0, 0), Vec3d(0.02, 0.09, 0)};
      for (int k = 0; k < 3; ++k) {
        rest.col(3 * e + k) = place + turn * corner[k];
        dx.col(3 * e + k) = turn * Vec3d(0.3 * corner[k].x(), -0.1 * corner[k].y(), 0);
      }
      triangles.push_back({3 * e, 3 * e + 1, 3 * e + 2});
    }
    StrainLimitBatch batch(triangles, rest, std::vector<double>(n, 0.02), std::vector<double>(n, 0.1), false);
    const double alpha = batch.step_bound(rest, dx);
    ASSERT_NEAR(alpha, 0.12 / 0.3, 1e-12);
    batch.measure(Positions(rest + alpha * dx));
    EXPECT_GT(batch.min_gap(), 0) << trial;
    EXPECT_EQ(batch.step_bound(rest, dx, alpha), alpha) << trial;
  }
}

TEST(StrainLimitBatch, SumsForPoliciesAreThoseOfTheElements) {
  const Strip strip(10);
  StrainLimitBatch batch = make_batch(strip, 0.1, 0.9);
  const std::size_t n = batch.size();
  std::vector<double> hess(81 * n, 0.0), element_mass(n, 0.3);
  for (std::size_t e = 0; e < n; ++e) {
    for (std::size_t i = 0; i < 9; ++i) hess[81 * e + 10 * i] = 1 + static_cast<double>(e);
  }
  const std::vector<double> mass(static_cast<std::size_t>(strip.rest.cols()), 0.01);
  std::vector<ElementSums<double>> sums(n);
  batch.stiffness_sums(strip.deformed, hess.data(), mass.data(), element_mass.data(), sums.data());
  const auto& t = strip.triangles[4];
  Vec3d centroid = Vec3d::Zero();
  for (const int v : t) centroid += strip.deformed.col(v) / 3;
  double w_sq = 0;
  for (const int v : t) w_sq += (strip.deformed.col(v) - centroid).squaredNorm();
  ASSERT_GT(w_sq, 0);
  EXPECT_NEAR(sums[4].elastic, 5 * w_sq, 1e-14);
  EXPECT_NEAR(sums[4].mass, 0.01 * w_sq, 1e-16);
  EXPECT_EQ(sums[4].element_mass, 0.3);
  EXPECT_EQ(sums[4].measure, batch.rests()[4].area);
  batch.stiffness_sums(strip.deformed, nullptr, mass.data(), element_mass.data(), sums.data());
  EXPECT_EQ(sums[4].elastic, 0);
}

TEST(StrainLimitBatch, BadColumnsAreConfigErrors) {
  const Strip strip(3);
  const std::vector<double> good(strip.triangles.size(), 0.1), bad(strip.triangles.size(), 0.0);
  EXPECT_THROW(StrainLimitBatch(strip.triangles, strip.rest, good, bad), ConfigError);
  EXPECT_THROW(StrainLimitBatch(strip.triangles, strip.rest, {0.1}, good), ConfigError);
}

}  // namespace
}  // namespace bb::test::strain_limit_batch_test
