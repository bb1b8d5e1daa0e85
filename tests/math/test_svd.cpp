// SVD of 2x2, 3x2 and 3x3: factors, signs, small singular values, degenerate input; float and double.
#include "core/math/svd.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "tests/oracle/dense.hpp"

namespace svd_test {
namespace {

using namespace bb;
using namespace bb::test;

/// The factors of `matrix`, the input rounded to its scalar.
struct Factors {
  MatXl matrix, U, V;
  VecXl sigma;
};

template <class T, int M, int N>
Factors factors(const MatXl& a) {
  const Mat<T, M, N> matrix = a.cast<T>();
  const auto svd = [&] {
    if constexpr (M == 2) return svd_2x2<T>(matrix);
    if constexpr (M == 3 && N == 2) return svd_3x2<T>(matrix);
    if constexpr (N == 3) return svd_3x3<T>(matrix);
  }();
  return {matrix.template cast<Long>(), svd.U.template cast<Long>(), svd.V.template cast<Long>(),
          svd.sigma.template cast<Long>()};
}

struct Case {
  const char* scalar;
  int m, n;
  double eps;
  Factors (*svd)(const MatXl&);
};
template <class T, int M, int N>
Case case_of(const char* scalar) {
  return {scalar, M, N, std::numeric_limits<T>::epsilon(), &factors<T, M, N>};
}
void PrintTo(const Case& c, std::ostream* out) { *out << c.scalar << " " << c.m << "x" << c.n; }

class SvdOf : public testing::TestWithParam<Case> {
 protected:
  const int m = GetParam().m, n = GetParam().n;
  const double eps = GetParam().eps;

  MatXl random_matrix(std::mt19937& rng) const {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return MatXl::NullaryExpr(m, n, [&] { return uniform(rng); });
  }

  /// Reconstruction, orthonormality, order and signs of the contract.
  void expect_svd(const MatXl& a) const {
    const auto [F, U, V, sigma] = GetParam().svd(a);
    const Long size = F.norm();
    EXPECT_LE((compose(U, sigma, V) - F).cwiseAbs().maxCoeff(), 20 * eps * size) << F;
    EXPECT_LE(orthonormality_error(U), 20 * eps) << F;
    EXPECT_LE(orthonormality_error(V), 20 * eps) << F;
    EXPECT_LE(std::abs(determinant(V) - 1), 20 * eps);
    if (m == n) {
      EXPECT_LE(std::abs(determinant(U) - 1), 20 * eps);
    } else {
      EXPECT_GE(sigma[n - 1], 0);
    }
    for (int i = 0; i + 1 < n; ++i) {
      EXPECT_GE(sigma[i], std::abs(sigma[i + 1]));
      EXPECT_GE(sigma[i], 0);
    }
    EXPECT_LE((sigma.cwiseAbs() - singular_values(F)).cwiseAbs().maxCoeff(), 8 * eps * size);
  }
};
INSTANTIATE_TEST_SUITE_P(All, SvdOf,
                         testing::Values(case_of<double, 2, 2>("double"), case_of<double, 3, 2>("double"),
                                         case_of<double, 3, 3>("double"), case_of<float, 2, 2>("float"),
                                         case_of<float, 3, 2>("float"), case_of<float, 3, 3>("float")),
                         [](const auto& c) {
                           return c.param.scalar + std::to_string(c.param.m) + std::to_string(c.param.n);
                         });

TEST_P(SvdOf, RandomMatrices) {
  std::mt19937 rng(17);
  int negative = 0;
  for (int k = 0; k < 300; ++k) {
    const MatXl a = random_matrix(rng);
    expect_svd(a);
    if (m == n) {
      const Factors out = GetParam().svd(a);
      EXPECT_GT(out.sigma[n - 1] * determinant(out.matrix), 0);
      negative += determinant(out.matrix) < 0;
    }
  }
  EXPECT_EQ(negative > 50, m == n);
}

TEST_P(SvdOf, DegenerateInputHasOrthonormalFactors) {
  std::mt19937 rng(19);
  const MatXl r = random_matrix(rng);
  expect_svd(MatXl::Zero(m, n));
  expect_svd(MatXl::Identity(m, n));
  expect_svd(-MatXl::Identity(m, n));
  expect_svd(MatXl::Ones(m, n));
  for (int j = 0; j < n; ++j) {
    MatXl one_column = MatXl::Zero(m, n), rank_one = one_column, repeated = r;
    one_column.col(j) = r.col(0);
    for (int k = 0; k < n; ++k) rank_one.col(k) = r(1, k) * r.col(0);
    repeated.col(j) = r.col((j + 1) % n);  // rank n - 1
    expect_svd(one_column);
    expect_svd(rank_one);
    expect_svd(repeated);
  }
  expect_svd(r * 1e-30L);
  expect_svd(r * 1e30L);
}

// Equal columns, orthogonal columns and repeated singular values of every kind: all matrices of -1, 0 and 1.
TEST_P(SvdOf, AllMatricesOfSmallIntegers) {
  int count = 1;
  for (int k = 0; k < m * n; ++k) count *= 3;
  for (int code = 0; code < count; ++code) {
    MatXl a(m, n);
    for (int k = 0, rest = code; k < m * n; ++k, rest /= 3) a(k % m, k / m) = rest % 3 - 1;
    expect_svd(a);
    if (HasFailure()) return;
  }
}

// 5e-19 is the rounding of the oracle. The area (or determinant) carries the small singular value: it is
// right to its own digits.
TEST_P(SvdOf, SmallSingularValuesKeepTheirDigits) {
  std::mt19937 rng(23);
  for (int k = 0; k < 50; ++k) {
    MatXl a = random_matrix(rng);
    const VecXl aside = a.col(1);
    a.col(1) = a.col(0) + std::sqrt(Long(eps)) * 0.1L * aside;  // normal equations would lose everything
    const Factors out = GetParam().svd(a);
    const Long exact = singular_values(out.matrix)[n - 1];
    ASSERT_GT(exact, 0);
    // 3x3: a few eps of the largest; 2 columns: of the value itself
    EXPECT_LE(std::abs(std::abs(out.sigma[n - 1]) - exact), n == 3 ? 8.0 * eps : 8.0 * eps * exact + 5e-19);
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
}  // namespace svd_test
