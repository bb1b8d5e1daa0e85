// PSD projection: known spectra in, clamped spectra out; matrices that need nothing come back bit for bit.
#include "core/math/psd.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace {

using namespace bb;

template <class T, int Size>
struct Case {
  using Scalar = T;
  static constexpr int n = Size;
};
template <class C>
class ProjectPsd : public testing::Test {};
using Cases =
    testing::Types<Case<double, 3>, Case<double, 6>, Case<double, 9>, Case<double, 12>, Case<float, 12>>;
TYPED_TEST_SUITE(ProjectPsd, Cases);

template <class T, int N>
Mat<T, N, N> random_basis(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Mat<T, N, N> a;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < N; ++i) a(i, j) = static_cast<T>(uniform(rng));
  }
  using MatX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;  // of fixed size it compiles for a minute
  return MatX(Eigen::HouseholderQR<MatX>(a).householderQ());
}

/// Symmetric to the last bit.
template <class T, int N>
Mat<T, N, N> compose(const Mat<T, N, N>& q, const Vec<T, N>& values) {
  const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> basis = q,
                                                         a = basis * values.asDiagonal() * basis.transpose();
  return (a + a.transpose()) / 2;
}

TYPED_TEST(ProjectPsd, ClampsTheNegativeEigenvaluesOnly) {
  using T = typename TypeParam::Scalar;
  constexpr int n = TypeParam::n;
  const T eps = std::numeric_limits<T>::epsilon();
  std::mt19937 rng(7);
  for (int n_negative = 1; n_negative <= n; ++n_negative) {
    const Mat<T, n, n> q = random_basis<T, n>(rng);
    Vec<T, n> values, clamped;
    for (int i = 0; i < n; ++i) {
      values[i] = static_cast<T>(i < n_negative ? -1 - i : 2 + i);
      clamped[i] = i < n_negative ? T(0) : values[i];
    }
    int count = -1;
    const Mat<T, n, n> out = project_psd<T, n>(compose<T, n>(q, values), &count);

    EXPECT_EQ(count, n_negative);
    EXPECT_EQ(out, (Mat<T, n, n>(out.transpose())));
    EXPECT_LE((out - compose<T, n>(q, clamped)).norm(), 200 * n * eps);
    EXPECT_EQ(out.norm() == T(0), n_negative == n);
  }
}

TYPED_TEST(ProjectPsd, PositiveMatricesComeBackUnchanged) {
  using T = typename TypeParam::Scalar;
  constexpr int n = TypeParam::n;
  std::mt19937 rng(11);
  const Mat<T, n, n> q = random_basis<T, n>(rng);
  Vec<T, n> values;
  for (int i = 0; i < n; ++i) values[i] = static_cast<T>(1 + i);
  const Mat<T, n, n> a = compose<T, n>(q, values);
  int count = -1;
  EXPECT_EQ((project_psd<T, n>(a, &count)), a);
  EXPECT_EQ(count, 0);
  EXPECT_EQ((project_psd<T, n>(Mat<T, n, n>::Zero(), &count)), (Mat<T, n, n>::Zero()));
  EXPECT_EQ(count, 0);
}

// Zero, rounding-sized and large eigenvalues together: nothing large is disturbed, nothing negative is left.
TYPED_TEST(ProjectPsd, MixedScales) {
  using T = typename TypeParam::Scalar;
  constexpr int n = TypeParam::n;
  const T eps = std::numeric_limits<T>::epsilon();
  std::mt19937 rng(13);
  const Mat<T, n, n> q = random_basis<T, n>(rng);
  Vec<T, n> values = Vec<T, n>::Zero();
  values[0] = T(1e6);
  values[1] = T(-1e-3) * T(1e6);
  values[2] = -eps;
  const Mat<T, n, n> a = compose<T, n>(q, values), out = project_psd<T, n>(a);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(Eigen::MatrixXd(out.template cast<double>()));
  EXPECT_NEAR(spectrum.eigenvalues()[n - 1], 1e6, 20.0 * eps * 1e6);
  EXPECT_GE(spectrum.eigenvalues()[0], -20.0 * eps * 1e6);
  EXPECT_GT((out - a).norm(), T(900));
}

TEST(HasPositivePivots, TellsDefiniteFromIndefinite) {
  Mat3d a = Mat3d::Identity();
  EXPECT_TRUE(has_positive_pivots(a));
  a(1, 0) = a(0, 1) = 2;
  EXPECT_FALSE(has_positive_pivots(a));
}

}  // namespace
