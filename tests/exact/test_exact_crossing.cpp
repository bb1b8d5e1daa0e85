// Edge against triangle by exact signs (core/audit) against rational arithmetic: the point where the line meets the plane
// for a crossing, a distance of zero for a touch. 0 wrong is required. BARRIERBENCH_EXACT_PAIRS as in
// test_exact_closest.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "core/audit/segment_triangle.hpp"
#include "tests/exact/exact_closest.hpp"
#include "tests/exact/hard_pairs.hpp"

namespace bb::test::exact_crossing_test {
namespace {

using audit::Crossing;
using Points = Mat<double, 3, 5>;  // segment p q, triangle a b c

mpq_class determinant(const ExactPair::Point& a, const ExactPair::Point& b, const ExactPair::Point& c) {
  return mpq_class(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]));
}

ExactPair::Point minus(const ExactPair::Point& a, const ExactPair::Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// Whether the line meets the plane in one point, strictly inside both. Cramer's rule for
/// p + t (q - p) = a + u (b - a) + v (c - a).
bool crosses(const std::vector<ExactPair::Point>& x) {
  const auto e = minus(x[3], x[2]), f = minus(x[4], x[2]), back = minus(x[0], x[1]), r = minus(x[0], x[2]);
  const mpq_class whole = determinant(back, e, f);
  if (whole == 0) return false;
  const mpq_class t = determinant(r, e, f) / whole, u = determinant(back, r, f) / whole,
                  v = determinant(back, e, r) / whole;
  return t > 0 && t < 1 && u > 0 && v > 0 && u + v < 1;
}

/// Distance 0 between some part of the one and some part of the other; a line through the inside is `crosses`.
bool meets(const Points& x) {
  const auto is_zero = [](std::initializer_list<Vec3d> points, int split) {
    Mat<double, 3, Eigen::Dynamic> columns(3, static_cast<Eigen::Index>(points.size()));
    Eigen::Index i = 0;
    for (const Vec3d& p : points) columns.col(i++) = p;
    return exact_distance(exact_pair(columns, split)).num == 0;
  };
  const Vec3d p = x.col(0), q = x.col(1), a = x.col(2), b = x.col(3), c = x.col(4);
  return is_zero({p, a, b, c}, 1) || is_zero({q, a, b, c}, 1) || is_zero({p, q, a, b}, 2) ||
         is_zero({p, q, b, c}, 2) || is_zero({p, q, c, a}, 2);
}

Crossing oracle(const Points& x) {
  if (crosses(exact_pair(x, 2).x)) return Crossing::crossing;
  return meets(x) ? Crossing::touch : Crossing::none;
}

/// A hard point and triangle; the segment goes from the point to its mirror image, to a corner, into the plane or
/// anywhere, or everything lies on a grid of a few points, where coincidences are the rule.
Points hard_case(Family family, std::mt19937_64& random) {
  std::uniform_int_distribution<int> choice(0, 4), small(-2, 2);
  const Mat<double, 3, 4> pair = hard_pair(family, PairKind::point_triangle, false, random);
  Points x;
  x << pair.col(0), pair.col(0), pair.col(1), pair.col(2), pair.col(3);
  switch (choice(random)) {
    case 0:
      x = Points::NullaryExpr([&] { return small(random); });
      break;
    case 1:
      x.col(1) = (x.col(2) + x.col(3) + x.col(4)) * (2.0 / 3) - x.col(0);
      break;
    case 2:
      x.col(1) = 2 * x.col(2) - x.col(0);
      break;
    case 3:
      x.col(1) = 0.5 * (x.col(3) + x.col(4));
      break;
    default:
      x.col(1) = -x.col(0).reverse();
      break;
  }
  return x;
}

long total_pairs() {
  const char* text = std::getenv("BARRIERBENCH_EXACT_PAIRS");
  return text ? std::max(1000L, std::strtol(text, nullptr, 10)) : 20000;
}

TEST(ExactCrossing, SegmentAgainstTriangle) {
  std::mt19937_64 random(3);
  long seen[3] = {0, 0, 0}, judged = 0, wrong = 0;
  for (long k = 0; k < total_pairs(); ++k) {
    const Points x = hard_case(static_cast<Family>(k % n_families), random);
    const Crossing found = audit::segment_triangle(x.col(0), x.col(1), x.col(2), x.col(3), x.col(4));
    const Crossing right = oracle(x);
    ++seen[static_cast<int>(right)];
    ++judged;
    if (found == right) continue;
    ++wrong;
    EXPECT_EQ(found, right) << x;
  }
  std::printf("segment against triangle: %ld judged, %ld apart, %ld touch, %ld cross, %ld wrong\n", judged,
              seen[0], seen[1], seen[2], wrong);
  EXPECT_EQ(wrong, 0);
  for (const long n : seen) EXPECT_GT(n, judged / 50);
}

}  // namespace
}  // namespace bb::test::exact_crossing_test
