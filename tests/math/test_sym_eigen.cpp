// Eigenvalues, by Jacobi (up to 4) and by QL, against known spectra, for float and double and all sizes in
// use.
#include "core/math/sym_eigen.hpp"

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
class SymEigen : public testing::Test {};
using Cases =
    testing::Types<Case<double, 2>, Case<double, 3>, Case<double, 5>, Case<double, 6>, Case<double, 9>,
                   Case<double, 12>, Case<float, 2>, Case<float, 3>, Case<float, 12>>;
TYPED_TEST_SUITE(SymEigen, Cases);

template <class T, int N>
Mat<T, N, N> random_symmetric(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Mat<T, N, N> a;
  for (int j = 0; j < N; ++j) {
    for (int i = j; i < N; ++i) a(i, j) = a(j, i) = static_cast<T>(uniform(rng));
  }
  return a;
}

template <class T, int N>
void expect_decomposition(const Mat<T, N, N>& a) {
  const T eps = std::numeric_limits<T>::epsilon(), norm = a.norm();
  Vec<T, N> values;
  Mat<T, N, N> fixed_vectors;
  sym_eigen<T, N>(a, values, fixed_vectors);

  // Of dynamic size from here on: the compiler would unroll every product.
  using MatX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  using MatXL = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const MatX vectors = fixed_vectors, matrix = a;
  EXPECT_LE((vectors * values.asDiagonal() * vectors.transpose() - matrix).norm(), 40 * eps * norm);
  EXPECT_LE((vectors.transpose() * vectors - MatX::Identity(N, N)).norm(), (10 * N) * eps);
  const Eigen::SelfAdjointEigenSolver<MatXL> oracle(MatXL(matrix.template cast<long double>()));
  for (int i = 0; i < N; ++i) {
    EXPECT_NEAR(static_cast<double>(values[i]), static_cast<double>(oracle.eigenvalues()[i]),
                10.0 * eps * norm);
    EXPECT_LE(values[i > 0 ? i - 1 : 0], values[i]);
  }
}

TYPED_TEST(SymEigen, RandomMatrices) {
  using T = typename TypeParam::Scalar;
  std::mt19937 rng(2);
  for (int k = 0; k < 30; ++k) expect_decomposition<T, TypeParam::n>(random_symmetric<T, TypeParam::n>(rng));
}

TYPED_TEST(SymEigen, RankOneZeroAndRepeated) {
  using T = typename TypeParam::Scalar;
  constexpr int n = TypeParam::n;
  std::mt19937 rng(3);
  const Vec<T, n> w = random_symmetric<T, n>(rng).col(0);
  ASSERT_GT(w.norm(), T(0));
  expect_decomposition<T, n>(w * w.transpose());
  expect_decomposition<T, n>(Mat<T, n, n>::Zero());
  expect_decomposition<T, n>(T(3) * Mat<T, n, n>::Identity());
  expect_decomposition<T, n>(Mat<T, n, n>::Identity() - w * w.transpose() / w.squaredNorm());
}

/// Blocks that do not meet, and entries on many scales: the tridiagonal matrix splits.
TYPED_TEST(SymEigen, DiagonalSplitAndGraded) {
  using T = typename TypeParam::Scalar;
  constexpr int n = TypeParam::n;
  std::mt19937 rng(7);
  Mat<T, n, n> a = random_symmetric<T, n>(rng);
  expect_decomposition<T, n>(Mat<T, n, n>(a.diagonal().asDiagonal()));
  Mat<T, n, n> split = a;
  split.topRightCorner(n / 2, n - n / 2).setZero();
  split.bottomLeftCorner(n - n / 2, n / 2).setZero();
  expect_decomposition<T, n>(split);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) a(i, j) *= std::pow(T(0.1), T(i + j));
  }
  expect_decomposition<T, n>(a);
}

/// As a device would see it: no endless loop, nothing that looks like an answer.
TYPED_TEST(SymEigen, NonFiniteGivesNonFinite) {
  using T = typename TypeParam::Scalar;
  constexpr int n = TypeParam::n;
  std::mt19937 rng(9);
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()}) {
    Mat<T, n, n> a = random_symmetric<T, n>(rng), vectors;
    a(0, n - 1) = a(n - 1, 0) = bad;
    Vec<T, n> values;
    sym_eigen<T, n>(a, values, vectors);
    EXPECT_FALSE(values.allFinite());
  }
}

TYPED_TEST(SymEigen, ScaleIsFree) {
  using T = typename TypeParam::Scalar;
  constexpr int n = TypeParam::n;
  std::mt19937 rng(5);
  const Mat<T, n, n> a = random_symmetric<T, n>(rng);
  Vec<T, n> values, scaled;
  Mat<T, n, n> vectors;
  sym_eigen<T, n>(a, values, vectors);
  for (const T scale : {T(1e-25), T(1e25)}) {
    sym_eigen<T, n>(a * scale, scaled, vectors);
    EXPECT_LE((scaled / scale - values).norm(), 40 * std::numeric_limits<T>::epsilon() * values.norm());
  }
}

// A well-scaled graded matrix: the small eigenvalue keeps its own digits.
TEST(SymEigenSmall, TinyEigenvalueKeepsItsDigits) {
  Mat<double, 2, 2> a;
  a << 1, 1e-9, 1e-9, 1e-12;  // det = 1e-12 - 1e-18
  Vec<double, 2> values;
  Mat<double, 2, 2> vectors;
  sym_eigen<double, 2>(a, values, vectors);
  const double exact = (1e-12 - 1e-18) / (1 + 1e-18);
  EXPECT_NEAR(values[0], exact, 1e-14 * exact);
  EXPECT_NEAR(values[1], 1, 1e-15);
}

}  // namespace
