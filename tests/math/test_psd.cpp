// PSD projection: known spectra in, clamped spectra out; matrices that need nothing come back bit for bit.
#include "core/math/psd.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

#include "tests/oracle/dense.hpp"

namespace psd_test {
namespace {

using namespace bb;
using namespace bb::test;

/// What project(.., psd) made of `matrix`, the input rounded to its scalar.
struct Projected {
  MatXl matrix, out;
  int n_clamped = -1;
};

template <class T, int N>
Projected project(const MatXl& a) {
  const Mat<T, N, N> matrix = a.cast<T>();
  int n_clamped = -1;
  const Mat<T, N, N> out = bb::project<T, N>(matrix, Projection::psd, &n_clamped);
  return {matrix.template cast<Long>(), out.template cast<Long>(), n_clamped};
}

struct Case {
  const char* scalar;
  int n;
  double eps;
  Projected (*project)(const MatXl&);
};
template <class T, int N>
Case case_of(const char* scalar) {
  return {scalar, N, std::numeric_limits<T>::epsilon(), &project<T, N>};
}
void PrintTo(const Case& c, std::ostream* out) { *out << c.scalar << " " << c.n; }

class ProjectPsd : public testing::TestWithParam<Case> {
 protected:
  const int n = GetParam().n;
  const double eps = GetParam().eps;

  MatXl random_basis(std::mt19937& rng) const {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return orthonormal_basis(MatXl::NullaryExpr(n, n, [&] { return uniform(rng); }));
  }
};
INSTANTIATE_TEST_SUITE_P(All, ProjectPsd,
                         testing::Values(case_of<double, 3>("double"), case_of<double, 6>("double"),
                                         case_of<double, 9>("double"), case_of<double, 12>("double"),
                                         case_of<float, 12>("float")),
                         [](const auto& c) { return c.param.scalar + std::to_string(c.param.n); });

/// Symmetric to the last bit.
MatXl symmetric(const MatXl& basis, const VecXl& values) {
  const MatXl a = compose(basis, values, basis);
  return (a + a.transpose()) / 2;
}

TEST_P(ProjectPsd, ClampsTheNegativeEigenvaluesOnly) {
  std::mt19937 rng(7);
  for (int n_negative = 1; n_negative <= n; ++n_negative) {
    const MatXl q = random_basis(rng);
    VecXl values(n), positive(n);
    for (int i = 0; i < n; ++i) {
      values[i] = i < n_negative ? -1 - i : 2 + i;
      positive[i] = i < n_negative ? 0 : values[i];
    }
    const Projected p = GetParam().project(symmetric(q, values));

    EXPECT_EQ(p.n_clamped, n_negative);
    EXPECT_EQ(p.out, p.out.transpose());
    EXPECT_LE((p.out - symmetric(q, positive)).norm(), 200 * n * eps);
    EXPECT_EQ(p.out.norm() == 0, n_negative == n);
  }
}

TEST_P(ProjectPsd, PositiveMatricesComeBackUnchanged) {
  std::mt19937 rng(11);
  const Projected p = GetParam().project(symmetric(random_basis(rng), VecXl::LinSpaced(n, 1, n)));
  EXPECT_EQ(p.out, p.matrix);
  EXPECT_GT(p.out.norm(), 1);
  EXPECT_EQ(p.n_clamped, 0);
  const Projected zero = GetParam().project(MatXl::Zero(n, n));
  EXPECT_TRUE(zero.out.isZero(0));
  EXPECT_EQ(zero.n_clamped, 0);
}

// Zero, rounding-sized and large eigenvalues together: nothing large is disturbed, nothing negative is left.
TEST_P(ProjectPsd, MixedScales) {
  std::mt19937 rng(13);
  VecXl values = VecXl::Zero(n);
  values[0] = 1e6;
  values[1] = -1e-3 * 1e6;
  values[2] = -eps;
  const Projected p = GetParam().project(symmetric(random_basis(rng), values));
  const VecXl spectrum = eigenvalues(p.out);
  EXPECT_NEAR(static_cast<double>(spectrum[n - 1]), 1e6, 20.0 * eps * 1e6);
  EXPECT_GE(spectrum[0], -20.0 * eps * 1e6);
  EXPECT_GT((p.out - p.matrix).norm(), 900);
}

/// A null vector that is split off changes nothing, wherever it points and however long it is.
/// In float the squares of such entries are no normal numbers, or nothing at all.
TEST(ProjectPsd, EntriesWithoutANormalSquareDoNoHarm) {
  for (const float tiny : {1e-19F, 1e-20F, 3e-22F, 1e-23F, 1e-30F}) {
    Mat<float, 9, 9> a = Mat<float, 9, 9>::Zero();
    for (int k = 0; k < 9; ++k) a(k, k) = k % 2 == 0 ? 1.0F : -1.0F;
    for (int k = 2; k < 9; ++k) a(k, 0) = a(0, k) = tiny;
    const Mat<float, 9, 9> out = bb::project<float, 9>(a, Projection::psd);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(out(k, k), k % 2 == 0 ? 1 : 0, 1e-6) << tiny;
  }
}

TEST(ProjectPsdBeside, EqualsTheProjectionOfTheWholeMatrix) {
  std::mt19937 rng(17);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 9; ++k) {
    const MatXl q = orthonormal_basis(MatXl::NullaryExpr(9, 9, [&] { return uniform(rng); }));
    VecXl values(9);
    for (int i = 0; i < 9; ++i) values[i] = i == k ? 0 : (i % 2 == 0 ? 1 + i : -1 - i);
    const Mat<double, 9, 9> a = symmetric(q, values).cast<double>();
    for (const double length : {1e-3, -5.0}) {
      const Vec<double, 9> u = (length * q.col(k)).cast<double>();
      const Mat<double, 9, 9> out = project_beside<double, 9>(a, u, Projection::psd);
      const MatXl truth = symmetric(q, values.cwiseMax(Long(0)));
      ASSERT_GT(truth.norm(), 1);
      EXPECT_LE((out.cast<Long>() - truth).norm(), 1e-14 * truth.norm());
      EXPECT_EQ(out, out.transpose());
    }
  }
}

TEST(HasPositivePivots, TellsDefiniteFromIndefinite) {
  Mat3d a = Mat3d::Identity();
  EXPECT_TRUE(has_positive_pivots(a));
  a(1, 0) = a(0, 1) = 2;
  EXPECT_FALSE(has_positive_pivots(a));
}

}  // namespace
}  // namespace psd_test
