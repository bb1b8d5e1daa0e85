// Gradient and Hessian of d and d^2 against differences in long double and against closed forms.
#include "core/geometry/distance_derivatives.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/geometry/closest_oracle.hpp"

namespace {

using namespace bb;
using namespace bb::test;

template <int N>
Points<Long, N> moved(const Points<Long, N>& x, int coordinate, Long step) {
  Points<Long, N> out = x;
  out(coordinate % 3, coordinate / 3) += step;
  return out;
}

/// Central differences of the oracle's distance and of its vector field w r/|r|, best over a ladder of steps.
template <PairKind K>
void expect_derivatives(const Points<double, pair_points(K)>& x, double tolerance) {
  constexpr int N = pair_points(K);
  const auto closest = closest_points<K, double>(x);
  const auto derivatives = distance_derivatives<double, N>(x, closest);
  const Points<Long, N> base = x.template cast<Long>();
  const auto value = [&](const Points<Long, N>& y) { return oracle_closest<K>(y).d; };
  const auto gradient = [&](const Points<Long, N>& y) {
    const auto c = oracle_closest<K>(y);
    Vec<Long, 3 * N> g;
    for (int i = 0; i < N; ++i) {
      g.template segment<3>(3 * i) = c.weights[i] * Vec<Long, 3>(c.r / c.d);
    }
    return g;
  };
  ASSERT_GT(derivatives.gradient.norm(), 0);
  ASSERT_GT(derivatives.hessian.norm(), 0);
  const double scale = std::max(1.0, derivatives.hessian.cwiseAbs().maxCoeff());
  for (int a = 0; a < 3 * N; ++a) {
    Long first = 1, second = 1;
    for (const Long h : {1e-4L, 1e-5L, 1e-6L, 1e-7L}) {
      const auto up = moved<N>(base, a, h), down = moved<N>(base, a, -h);
      const Long slope = (value(up) - value(down)) / (2 * h);
      first = std::min(first, std::abs(slope - static_cast<Long>(derivatives.gradient[a])));
      const Vec<Long, 3 * N> column = (gradient(up) - gradient(down)) / (2 * h);
      second =
          std::min(second, (column - derivatives.hessian.col(a).template cast<Long>()).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(static_cast<double>(first), tolerance) << region_name(closest.region);
    EXPECT_LE(static_cast<double>(second), tolerance * scale) << region_name(closest.region);
  }
  EXPECT_LE((derivatives.hessian - derivatives.hessian.transpose()).norm(), 1e-12 * scale);
}

template <PairKind K>
void expect_derivatives_in_every_region(std::size_t n_regions_of_kind) {
  constexpr int wanted = 3;  // configurations a region, away from its borders
  std::mt19937 rng(37);
  std::map<Region, int> seen;
  for (int k = 0; k < 4000; ++k) {
    const auto x = random_points<pair_points(K)>(rng);
    const auto oracle = oracle_closest<K>(x);
    const Region region = closest_points<K, double>(x).region;
    if (oracle.least_weight < 0.1L || oracle.d < 0.2L || seen[region] >= wanted) continue;
    // every neighbour within a step is of the same region
    bool inside = true;
    for (int a = 0; a < 6 * pair_points(K); ++a) {
      const auto y = moved<pair_points(K)>(x.template cast<Long>(), a / 2, a % 2 ? 1e-3L : -1e-3L);
      inside = inside && region_word<K>(oracle_closest<K>(y).weights) == region_name(region);
    }
    if (!inside) continue;
    ++seen[region];
    expect_derivatives<K>(x, 1e-8);
  }
  EXPECT_EQ(seen.size(), n_regions_of_kind);
  for (const auto& [region, count] : seen) EXPECT_EQ(count, wanted) << region_name(region);
}

TEST(DistanceDerivatives, PointPoint) { expect_derivatives_in_every_region<PairKind::point_point>(1); }
TEST(DistanceDerivatives, PointEdge) { expect_derivatives_in_every_region<PairKind::point_edge>(3); }
TEST(DistanceDerivatives, PointTriangle) { expect_derivatives_in_every_region<PairKind::point_triangle>(7); }
TEST(DistanceDerivatives, EdgeEdge) { expect_derivatives_in_every_region<PairKind::edge_edge>(9); }

TEST(DistanceDerivatives, PointPointHasItsClosedForm) {
  Points<double, 2> x;
  x << 1, 1, 2, 2, 3, 1;  // r = (0, 0, 2)
  const auto out = distance_derivatives<double, 2>(x, closest_point_point(x));
  Vec<double, 6> gradient;
  gradient << 0, 0, 1, 0, 0, -1;
  Mat<double, 6, 6> hessian = Mat<double, 6, 6>::Zero();
  for (const int k : {0, 1}) {
    hessian(k, k) = hessian(k + 3, k + 3) = 0.5;
    hessian(k, k + 3) = hessian(k + 3, k) = -0.5;
  }
  EXPECT_EQ(out.gradient, gradient);
  EXPECT_EQ(out.hessian, hessian);
}

// Over a fixed plane the distance is linear in the point, however small it is: nothing cancels.
TEST(DistanceDerivatives, TinyGapsOverTrianglesKeepTheirDigits) {
  Points<double, 4> x;
  x << 0.3, 0, 1, 0, 0.3, 0, 0, 1, 1, 0, 0, 0;
  const auto reference = distance_derivatives<double, 4>(x, closest_point_triangle(x));
  for (const double gap : {1e-3, 1e-8, 1e-12}) {
    x(2, 0) = gap;
    const auto out = distance_derivatives<double, 4>(x, closest_point_triangle(x));
    EXPECT_EQ((out.hessian.topLeftCorner<3, 3>().norm()), 0);
    EXPECT_LE((out.gradient - reference.gradient).norm(), 1e-15);
    // d w_1/d p_x = -1 moves the normal's weight: the mixed block is of order 1/size, not 1/gap
    EXPECT_GT(out.hessian.norm(), 1);
    EXPECT_LT(out.hessian.norm(), 10);
  }
}

}  // namespace
