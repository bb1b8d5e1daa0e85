// Numeric projections against Eigen's in long double: any symmetric 12 x 12, any number of them.
#include "core/contact/numeric_projection.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/math/lower_blocks.hpp"
#include "tests/oracle/dense.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::numeric_projection_test {
namespace {

constexpr std::size_t n_numbers = n_lower_numbers(4);
constexpr HessianMode modes[] = {HessianMode::projected_numeric, HessianMode::projected_lapack,
                                 HessianMode::projected_low_rank};

/// n symmetric matrices with random entries, the k-th of rank 1 + k % 12: half of the eigenvalues are negative.
std::vector<double> random_hessians(std::size_t n) {
  std::mt19937 rng(11);
  std::normal_distribution<double> normal;
  std::vector<double> out(n_numbers * n);
  for (std::size_t k = 0; k < n; ++k) {
    Mat<double, 12, 12> full = Mat<double, 12, 12>::Zero();
    for (std::size_t term = 0; term <= k % 12; ++term) {
      const Vec<double, 12> v = Vec<double, 12>::NullaryExpr([&] { return normal(rng); });
      full += (term % 2 == 0 ? -1.0 : 1.0) * v * v.transpose();
    }
    store_lower_blocks(4, full, &out[n_numbers * k]);
  }
  return out;
}

MatXl expected(const MatXl& h, Projection projection, bool* negative) {
  Spectrum own = spectrum(h);
  *negative = own.values[0] < -1;
  for (Long& value : own.values)
    value = projection == Projection::psd ? std::max(value, 0.0L) : std::abs(value);
  return compose(own.vectors, own.values, own.vectors);
}

TEST(NumericProjection, AgreesWithEigenInLongDouble) {
  const std::size_t n = 27;  // the last three are no whole group of four
  const std::vector<double> exact = random_hessians(n);
  for (const HessianMode mode : modes) {
    for (const Projection projection : {Projection::psd, Projection::absolute}) {
      std::vector<double> hess = exact;
      project_numerically(mode, projection, n, hess.data());
      for (std::size_t k = 0; k < n; ++k) {
        bool negative = false;
        const MatXl before = from_lower_blocks(&exact[n_numbers * k], 4).cast<long double>();
        const MatXl after = from_lower_blocks(&hess[n_numbers * k], 4).cast<long double>();
        const MatXl truth = expected(before, projection, &negative);
        EXPECT_TRUE(negative) << k;
        EXPECT_LE((after - truth).norm(), 1e-13L * before.norm()) << k;
        EXPECT_EQ(after.norm() > 1, projection == Projection::absolute || k % 12 > 0) << k;
      }
    }
  }
}

TEST(NumericProjection, KeepsWhatIsPositive) {
  Mat<double, 12, 12> full = Mat<double, 12, 12>::Identity();
  full(3, 8) = full(8, 3) = 0.5;
  std::vector<double> exact(n_numbers);
  store_lower_blocks(4, full, exact.data());
  for (const HessianMode mode : modes) {
    std::vector<double> hess = exact;
    project_numerically(mode, Projection::psd, 1, hess.data());
    for (std::size_t k = 0; k < n_numbers; ++k) EXPECT_NEAR(hess[k], exact[k], 1e-14);
  }
}

TEST(NumericProjection, DoesNotHideWhatIsNotFinite) {
  for (const HessianMode mode : modes) {
    std::vector<double> hess = random_hessians(8);
    hess[4 * n_numbers + 10] = std::numeric_limits<double>::quiet_NaN();
    project_numerically(mode, Projection::psd, 8, hess.data());
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_EQ(from_lower_blocks(&hess[n_numbers * k], 4).allFinite(), k != 4) << k;
    }
  }
}

TEST(NumericProjection, RefusesAModeThatIsNone) {
  std::vector<double> hess(n_numbers);
  EXPECT_THROW(project_numerically(HessianMode::projected_full, Projection::psd, 1, hess.data()),
               std::invalid_argument);
}

}  // namespace
}  // namespace bb::test::numeric_projection_test
