// Eigenvalues, by Jacobi (up to 4) and by QL, against known spectra, for float and double and all
// sizes in use.
#include "core/math/sym_eigen.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

#include "tests/oracle/dense.hpp"

namespace sym_eigen_test {
namespace {

using namespace bb;
using namespace bb::test;

/// What sym_eigen made of `matrix`, the input rounded to its scalar.
struct Decomposition {
  MatXl matrix, vectors;
  VecXl values;
};

template <class T, int N>
Decomposition decompose(const MatXd& a) {
  const Mat<T, N, N> matrix = a.cast<T>();
  Vec<T, N> values;
  Mat<T, N, N> vectors;
  sym_eigen<T, N>(matrix, values, vectors);
  return {matrix.template cast<Long>(), vectors.template cast<Long>(), values.template cast<Long>()};
}

struct Case {
  const char* scalar;
  int n;
  double eps;
  Decomposition (*decompose)(const MatXd&);
};
template <class T, int N>
Case case_of(const char* scalar) {
  return {scalar, N, std::numeric_limits<T>::epsilon(), &decompose<T, N>};
}
void PrintTo(const Case& c, std::ostream* out) { *out << c.scalar << " " << c.n; }

class SymEigen : public testing::TestWithParam<Case> {
 protected:
  const int n = GetParam().n;
  const double eps = GetParam().eps;

  MatXd random_symmetric(std::mt19937& rng) const {
    std::uniform_real_distribution<double> uniform(-1, 1);
    MatXd a(n, n);
    for (int j = 0; j < n; ++j) {
      for (int i = j; i < n; ++i) a(i, j) = a(j, i) = uniform(rng);
    }
    return a;
  }

  void expect_decomposition(const MatXd& a) const {
    const auto [matrix, vectors, values] = GetParam().decompose(a);
    const Long norm = matrix.norm();
    EXPECT_LE((compose(vectors, values, vectors) - matrix).norm(), 40 * eps * norm);
    EXPECT_LE(orthonormality_error(vectors), (10 * n) * eps);
    const VecXl truth = eigenvalues(matrix);
    for (int i = 0; i < n; ++i) {
      EXPECT_LE(std::abs(values[i] - truth[i]), 10 * eps * norm);
      EXPECT_LE(values[i > 0 ? i - 1 : 0], values[i]);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(All, SymEigen,
                         testing::Values(case_of<double, 2>("double"), case_of<double, 3>("double"),
                                         case_of<double, 5>("double"), case_of<double, 6>("double"),
                                         case_of<double, 9>("double"), case_of<double, 12>("double"),
                                         case_of<float, 2>("float"), case_of<float, 3>("float"),
                                         case_of<float, 12>("float")),
                         [](const auto& c) { return c.param.scalar + std::to_string(c.param.n); });

TEST_P(SymEigen, RandomMatrices) {
  std::mt19937 rng(2);
  for (int k = 0; k < 30; ++k) expect_decomposition(random_symmetric(rng));
}

TEST_P(SymEigen, RankOneZeroAndRepeated) {
  std::mt19937 rng(3);
  const VecXd w = random_symmetric(rng).col(0);
  const MatXd identity = MatXd::Identity(n, n);
  ASSERT_GT(w.norm(), 0);
  expect_decomposition(w * w.transpose());
  expect_decomposition(MatXd::Zero(n, n));
  expect_decomposition(3 * identity);
  expect_decomposition(identity - w * w.transpose() / w.squaredNorm());
}

/// Blocks that do not meet, and entries on many scales: the tridiagonal matrix splits.
TEST_P(SymEigen, DiagonalSplitAndGraded) {
  std::mt19937 rng(7);
  MatXd a = random_symmetric(rng);
  expect_decomposition(a.diagonal().asDiagonal());
  MatXd split = a;
  split.topRightCorner(n / 2, n - n / 2).setZero();
  split.bottomLeftCorner(n - n / 2, n / 2).setZero();
  expect_decomposition(split);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) a(i, j) *= std::pow(0.1, i + j);
  }
  expect_decomposition(a);
}

/// As a device would see it: no endless loop, nothing that looks like an answer.
TEST_P(SymEigen, NonFiniteGivesNonFinite) {
  std::mt19937 rng(9);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    MatXd a = random_symmetric(rng);
    a(0, n - 1) = a(n - 1, 0) = bad;
    EXPECT_FALSE(GetParam().decompose(a).values.allFinite());
  }
}

TEST_P(SymEigen, ScaleIsFree) {
  std::mt19937 rng(5);
  const MatXd a = random_symmetric(rng);
  const VecXl values = GetParam().decompose(a).values;
  for (const double scale : {1e-25, 1e25}) {
    const VecXl scaled = GetParam().decompose(a * scale).values;
    EXPECT_LE((scaled / scale - values).norm(), 40 * eps * values.norm());
  }
}

// A well-scaled graded matrix: the small eigenvalue keeps its own digits.
TEST(SymEigenSmall, TinyEigenvalueKeepsItsDigits) {
  MatXd a(2, 2);
  a << 1, 1e-9, 1e-9, 1e-12;  // det = 1e-12 - 1e-18
  const VecXl values = decompose<double, 2>(a).values;
  const double exact = (1e-12 - 1e-18) / (1 + 1e-18);
  EXPECT_NEAR(static_cast<double>(values[0]), exact, 1e-14 * exact);
  EXPECT_NEAR(static_cast<double>(values[1]), 1, 1e-15);
}

}  // namespace
}  // namespace sym_eigen_test
