// SVD of 2x2, 3x2 and 3x3: factors, signs, small singular values, degenerate input; float and double.
#include "core/math/svd.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace {

using namespace bb;

template <class T, int Rows, int Cols>
struct Case {
  using Scalar = T;
  static constexpr int m = Rows, n = Cols;
};
template <class C>
class SvdOf : public testing::Test {};
using Cases = testing::Types<Case<double, 2, 2>, Case<double, 3, 2>, Case<double, 3, 3>, Case<float, 2, 2>,
                             Case<float, 3, 2>, Case<float, 3, 3>>;
TYPED_TEST_SUITE(SvdOf, Cases);

template <class T, int M, int N>
Svd<T, M, N> svd(const Mat<T, M, N>& F) {
  if constexpr (M == 2) return svd_2x2<T>(F);
  if constexpr (M == 3 && N == 2) return svd_3x2<T>(F);
  if constexpr (N == 3) return svd_3x3<T>(F);
}

template <class T, int M, int N>
Mat<T, M, N> random_matrix(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Mat<T, M, N> a;
  for (int j = 0; j < N; ++j) {
    for (int i = 0; i < M; ++i) a(i, j) = static_cast<T>(uniform(rng));
  }
  return a;
}

/// Reconstruction, orthonormality, order and signs of the contract.
template <class T, int M, int N>
void expect_svd(const Mat<T, M, N>& F) {
  const T eps = std::numeric_limits<T>::epsilon();
  const double size = F.template cast<double>().norm();  // does not underflow
  const Svd<T, M, N> out = svd<T, M, N>(F);
  EXPECT_LE((out.U * out.sigma.asDiagonal() * out.V.transpose() - F).cwiseAbs().maxCoeff(), 20.0 * eps * size)
      << F;
  EXPECT_LE((out.U.transpose() * out.U - Mat<T, N, N>::Identity()).norm(), 20 * eps) << F;
  EXPECT_LE((out.V.transpose() * out.V - Mat<T, N, N>::Identity()).norm(), 20 * eps) << F;
  EXPECT_NEAR(out.V.determinant(), T(1), 20 * eps);
  if constexpr (M == N) {
    EXPECT_NEAR(out.U.determinant(), T(1), 20 * eps);
  } else {
    EXPECT_GE(out.sigma[N - 1], T(0));
  }
  for (int i = 0; i + 1 < N; ++i) {
    EXPECT_GE(out.sigma[i], std::abs(out.sigma[i + 1]));
    EXPECT_GE(out.sigma[i], T(0));
  }
  const Eigen::JacobiSVD<Eigen::Matrix<long double, M, N>> oracle(F.template cast<long double>());
  for (int i = 0; i < N; ++i) {
    EXPECT_NEAR(static_cast<double>(std::abs(out.sigma[i])), static_cast<double>(oracle.singularValues()[i]),
                8.0 * eps * size);
  }
}

TYPED_TEST(SvdOf, RandomMatrices) {
  using T = typename TypeParam::Scalar;
  std::mt19937 rng(17);
  int negative = 0;
  for (int k = 0; k < 300; ++k) {
    const Mat<T, TypeParam::m, TypeParam::n> F = random_matrix<T, TypeParam::m, TypeParam::n>(rng);
    expect_svd<T, TypeParam::m, TypeParam::n>(F);
    if constexpr (TypeParam::m == TypeParam::n) {
      const auto out = svd<T, TypeParam::m, TypeParam::n>(F);
      EXPECT_GT(out.sigma[TypeParam::n - 1] * F.determinant(), T(0));
      negative += F.determinant() < 0;
    }
  }
  EXPECT_EQ(negative > 50, TypeParam::m == TypeParam::n);
}

TYPED_TEST(SvdOf, DegenerateInputHasOrthonormalFactors) {
  using T = typename TypeParam::Scalar;
  constexpr int m = TypeParam::m, n = TypeParam::n;
  using Matrix = Mat<T, m, n>;
  std::mt19937 rng(19);
  const Matrix r = random_matrix<T, m, n>(rng);
  expect_svd<T, m, n>(Matrix::Zero());
  expect_svd<T, m, n>(Matrix::Identity());
  expect_svd<T, m, n>(-Matrix::Identity());
  expect_svd<T, m, n>(Matrix::Ones());
  for (int j = 0; j < n; ++j) {
    expect_svd<T, m, n>(r.col(0) * Vec<T, n>::Unit(j).transpose());  // one column alone
    expect_svd<T, m, n>(r.col(0) * r.row(1));                        // rank 1
    Matrix repeated = r;
    repeated.col(j) = repeated.col((j + 1) % n);  // rank n - 1
    expect_svd<T, m, n>(repeated);
  }
  expect_svd<T, m, n>(r * T(1e-30));
  expect_svd<T, m, n>(r * T(1e30));
}

// Equal columns, orthogonal columns and repeated singular values of every kind: all matrices of -1, 0 and 1.
TYPED_TEST(SvdOf, AllMatricesOfSmallIntegers) {
  using T = typename TypeParam::Scalar;
  constexpr int m = TypeParam::m, n = TypeParam::n;
  int count = 1;
  for (int k = 0; k < m * n; ++k) count *= 3;
  for (int code = 0; code < count; ++code) {
    Mat<T, m, n> F;
    for (int k = 0, rest = code; k < m * n; ++k, rest /= 3) F(k % m, k / m) = static_cast<T>(rest % 3 - 1);
    expect_svd<T, m, n>(F);
    if (this->HasFailure()) return;
  }
}

// 5e-19 is the rounding of the oracle. The area (or determinant) carries the small singular value: it is
// right to its own digits.
TYPED_TEST(SvdOf, SmallSingularValuesKeepTheirDigits) {
  using T = typename TypeParam::Scalar;
  constexpr int m = TypeParam::m, n = TypeParam::n;
  const T eps = std::numeric_limits<T>::epsilon();
  std::mt19937 rng(23);
  for (int k = 0; k < 50; ++k) {
    Mat<T, m, n> F = random_matrix<T, m, n>(rng);
    const Vec<T, m> aside = F.col(1);
    F.col(1) = F.col(0) + std::sqrt(eps) * T(0.1) * aside;  // normal equations would lose everything
    const Eigen::JacobiSVD<Eigen::Matrix<long double, m, n>> oracle(F.template cast<long double>());
    const double exact = static_cast<double>(oracle.singularValues()[n - 1]);
    ASSERT_GT(exact, 0);
    const double found = static_cast<double>(std::abs(svd<T, m, n>(F).sigma[n - 1]));
    // 3x3: a few eps of the largest; 2 columns: of the value itself
    EXPECT_NEAR(found, exact, n == 3 ? 8.0 * eps : 8.0 * eps * exact + 5e-19);
  }
}

TEST(Svd22, ShearHasItsClosedForm) {
  Mat<double, 2, 2> F;
  F << 1, 1, 0, 1;  // singular values: the golden ratio and its inverse
  const double golden = (1 + std::sqrt(5.0)) / 2;
  const auto out = svd_2x2<double>(F);
  EXPECT_NEAR(out.sigma[0], golden, 1e-15);
  EXPECT_NEAR(out.sigma[1], 1 / golden, 1e-15);
  F << 1, 0, 0, -2;
  EXPECT_NEAR(svd_2x2<double>(F).sigma[1], -1, 1e-15);
}

}  // namespace
