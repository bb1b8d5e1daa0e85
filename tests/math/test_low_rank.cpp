// The projection that stops at the rank: every rank, places of the zeros, lanes of several ranks.
#include "core/math/low_rank.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/math/lanes.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::test::low_rank_test {
namespace {

constexpr int n = 12;
using Matrix = Mat<double, n, n>;

struct Known {
  Matrix matrix;
  MatXl psd, absolute;
};

/// `rank` eigenvalues of either sign over four decades, in the span of the unit vectors from `first` on.
Known known(int rank, int first, std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int m = n - first;
  const MatXl q = orthonormal_basis(MatXl::NullaryExpr(m, m, [&] { return uniform(rng); }));
  VecXl values = VecXl::Zero(m);
  for (int k = 0; k < rank; ++k) values[k] = (k % 2 == 0 ? -3 : 2) * std::pow(10.0, 4.0 * k / n);
  const auto whole = [&](const VecXl& of) {
    MatXl out = MatXl::Zero(n, n);
    out.bottomRightCorner(m, m) = compose(q, of, q);
    return out;
  };
  const MatXl a = whole(values);
  return {((a + a.transpose()) / 2).cast<double>(), whole(values.cwiseMax(Long(0))),
          whole(values.cwiseAbs())};
}

TEST(ProjectLowRank, IsTheProjectionAtEveryRank) {
  std::mt19937 rng(3);
  for (const int first : {0, 3}) {
    for (int rank = 1; rank <= n - first; ++rank) {
      const Known k = known(rank, first, rng);
      const Matrix psd = project_low_rank<6>(k.matrix, Projection::psd);
      const Matrix absolute = project_low_rank<6>(k.matrix, Projection::absolute);
      const Long size = k.matrix.norm();
      EXPECT_GT((k.psd - k.matrix.cast<Long>()).norm(), 1) << rank;  // something negative is there to remove
      EXPECT_LE((psd.cast<Long>() - k.psd).norm(), 1e-13L * size) << rank;
      EXPECT_LE((absolute.cast<Long>() - k.absolute).norm(), 1e-13L * size) << rank;
      EXPECT_EQ(psd, psd.transpose());
      EXPECT_EQ(psd.norm() > 1, rank > 1) << rank;
    }
  }
}

TEST(ProjectLowRank, StopsOneRowBehindTheRank) {
  std::mt19937 rng(5);
  for (int rank = 1; rank <= 6; ++rank) {
    const Known k = known(rank, 0, rng);
    Matrix a = k.matrix / k.matrix.cwiseAbs().maxCoeff();
    EXPECT_LE((detail::LeadingRows<double, n>(a).n), rank + 1);
  }
  Matrix zero = Matrix::Zero();
  EXPECT_EQ((detail::LeadingRows<double, n>(zero).n), 0);
  EXPECT_TRUE(project_low_rank<6>(zero, Projection::psd).isZero(0));
}

/// Its first row is zero but beside the diagonal: what couples rows counts as much as what is on them.
TEST(ProjectLowRank, KeepsACouplingWithoutADiagonal) {
  Matrix a = Matrix::Zero();
  a(0, 5) = a(5, 0) = 2;
  const Matrix out = project_low_rank<6>(a, Projection::psd);
  for (const int i : {0, 5}) {
    for (const int j : {0, 5}) EXPECT_NEAR(out(i, j), 1, 1e-14);
  }
  EXPECT_NEAR(out.norm(), 2, 1e-14);
}

TEST(ProjectLowRank, NoLaneDependsOnAnother) {
  using L = Lanes<double, 4>;
  std::mt19937 rng(7);
  Matrix ranks[4] = {known(1, 0, rng).matrix, known(5, 0, rng).matrix, known(12, 0, rng).matrix,
                     Matrix::Zero()};
  Mat<L, n, n> together;
  for (int lane = 0; lane < 4; ++lane) {
    for (int k = 0; k < n * n; ++k) together.data()[k].v[lane] = ranks[lane].data()[k];
  }
  together = project_low_rank<6>(together, Projection::psd);
  for (int lane = 0; lane < 4; ++lane) {
    Mat<L, n, n> alone;
    for (int k = 0; k < n * n; ++k) alone.data()[k] = L(ranks[lane].data()[k]);
    alone = project_low_rank<6>(alone, Projection::psd);
    for (int k = 0; k < n * n; ++k) EXPECT_EQ(alone.data()[k][lane], together.data()[k][lane]) << lane;
  }
}

TEST(ProjectLowRank, DoesNotHideWhatIsNotFinite) {
  Matrix a = Matrix::Identity();
  a(7, 2) = a(2, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(project_low_rank<6>(a, Projection::psd).allFinite());
}

}  // namespace
}  // namespace bb::test::low_rank_test
