// The proofs in integers against the same decisions by polynomials: motions between small integer points, where
// everything can be multiplied out.
#include "core/audit/exact_polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace bb::audit::exact_polygon_test {
namespace {

using Long = std::int64_t;
using Long3 = std::array<Long, 3>;

Long3 cross(const Long3& a, const Long3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Long dot(const Long3& a, const Long3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
int sign(Long v) { return (v > 0) - (v < 0); }

constexpr int eighths = 8;  // times are multiples of it

TimeSpan span_of(int begin, int end) {
  return {TimeSpan::one / eighths * begin, TimeSpan::one / eighths * end};
}

/// 16 times corner k, which is a difference of two points, at t sixteenths.
template <class Pair>
Long3 corner_at(const PairMotion<Pair>& m, int k, Long t) {
  Long3 out{0, 0, 0};
  const auto i = static_cast<std::size_t>(Pair::corner[k][0]),
             j = static_cast<std::size_t>(Pair::corner[k][1]);
  for (int c = 0; c < Pair::dim; ++c) {
    const auto a = static_cast<Long>(m.x0[i][c] - m.x0[j][c]), b = static_cast<Long>(m.x1[i][c] - m.x1[j][c]);
    out[static_cast<std::size_t>(c)] = (16 - t) * a + t * b;
  }
  return out;
}

template <class Pair>
Long plane_height(const PairMotion<Pair>& m, Long t) {
  const Long3 a = corner_at(m, 0, t), b = corner_at(m, 1, t);
  if constexpr (Pair::dim == 2) return a[0] * b[1] - a[1] * b[0];
  return dot(a, cross(b, corner_at(m, 2, t)));
}

/// The coefficients of n . (D_k x D_k+1) on the span, a quadratic; the middle one is twice the value half-way less the
/// mean of the ends. All of one sign for every k, and the origin on the two sides of the plane at the ends.
template <class Pair>
bool expected_passage(const PairMotion<Pair>& m, const Long3& n, int begin, int end) {
  const Long b = 2 * begin, e = 2 * end;  // sixteenths
  if (sign(plane_height(m, b)) * sign(plane_height(m, e)) >= 0) return false;
  int common = 0;
  for (int k = 0; k < Pair::n_corners; ++k) {
    const auto height = [&](Long t) {
      return dot(n, cross(corner_at(m, k, t), corner_at(m, (k + 1) % Pair::n_corners, t)));
    };
    const Long first = height(b), last = height(e), middle = 4 * height((b + e) / 2) - first - last;
    for (const Long value : {first, middle, last}) {
      if (value == 0 || sign(value) == -common) return false;
      common = sign(value);
    }
  }
  return true;
}

/// In the plane the line along n keeps the two corners on two sides, at both ends.
bool expected_passage_2d(const PairMotion<VertexEdge2d>& m, const Long3& n, int begin, int end) {
  if (sign(plane_height(m, 2 * begin)) * sign(plane_height(m, 2 * end)) >= 0) return false;
  const auto side = [&](int k, int t) {
    const Long3 d = corner_at(m, k, 2 * t);
    return sign(n[0] * d[1] - n[1] * d[0]);
  };
  const int s = side(0, begin);
  return s != 0 && side(0, end) == s && side(1, begin) == -s && side(1, end) == -s;
}

/// Points that cross each other's middle when the first primitive goes down, in x, y and z.
constexpr int base_vertex_triangle[4][2] = {{0, 0}, {-6, -6}, {6, -6}, {0, 6}};
constexpr int base_edge_edge[4][2] = {{-6, 0}, {6, 0}, {0, -6}, {0, 6}};
constexpr int base_vertex_edge[4][2] = {{0, 0}, {-6, 0}, {6, 0}, {0, 0}};

/// Integers round such a passage: nearly every other one is none.
template <class Pair>
PairMotion<Pair> random_motion(std::mt19937& random) {
  std::uniform_int_distribution<int> c(-4, 4);
  const auto& base = Pair::dim == 2         ? base_vertex_edge
                     : Pair::n_corners == 4 ? base_edge_edge
                                            : base_vertex_triangle;
  PairMotion<Pair> m;
  for (std::size_t k = 0; k < m.x0.size(); ++k) {
    for (int i = 0; i + 1 < Pair::dim; ++i) {
      m.x0[k][i] = base[k][i] + c(random);
      m.x1[k][i] = base[k][i] + c(random);
    }
    const int up = k < (Pair::n_corners == 4 ? 2U : 1U) ? 4 : 0;
    m.x0[k][Pair::dim - 1] = up + c(random) / 2;
    m.x1[k][Pair::dim - 1] = -up + c(random) / 2;
  }
  return m;
}

struct Tally {
  int proven = 0, not_proven = 0;
};

template <class Pair>
Tally compare(int n_motions) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> c(-3, 3), time(0, eighths);
  Tally tally;
  for (int i = 0; i < n_motions; ++i) {
    const PairMotion<Pair> m = random_motion<Pair>(random);
    Long3 n{c(random), c(random), c(random)};
    n[static_cast<std::size_t>(Pair::dim) - 1] += 6;
    if (Pair::dim == 2) n[2] = 0;
    int begin = time(random), end = time(random);
    if (i % 2) begin = 0, end = eighths;
    if (begin > end) std::swap(begin, end);
    typename ExactPolygon<Pair>::Point direction;
    for (int k = 0; k < Pair::dim; ++k) direction[k] = static_cast<double>(n[static_cast<std::size_t>(k)]);
    bool expected = false;
    if constexpr (Pair::dim == 2) {
      expected = expected_passage_2d(m, n, begin, end);
    } else {
      expected = expected_passage(m, n, begin, end);
    }
    const bool found = ExactPolygon<Pair>(m).proves_passage(direction, span_of(begin, end));
    EXPECT_EQ(found, expected) << "motion " << i << ", eighths " << begin << " to " << end;
    ++(expected ? tally.proven : tally.not_proven);
  }
  return tally;
}

TEST(ExactPolygon, ProvesWhatItsPolynomialsProve) {
  for (const Tally& tally :
       {compare<VertexTriangle>(3000), compare<EdgeEdge>(3000), compare<VertexEdge2d>(2000)}) {
    EXPECT_GT(tally.proven, 60);
    EXPECT_GT(tally.not_proven, 500);
  }
}

template <class Pair>
void compare_planes(int n_motions) {
  std::mt19937 random(17);
  int flat = 0;
  for (int i = 0; i < n_motions; ++i) {
    PairMotion<Pair> m = random_motion<Pair>(random);
    if (i % 3 == 0) {  // on the vertex 1 all the time
      m.x0[0] = m.x0[1];
      m.x1[0] = m.x1[1];
      if (Pair::n_corners == 4) std::swap(m.x0[1], m.x0[2]), std::swap(m.x1[1], m.x1[2]);
    }
    bool expected = true;
    for (Long t = 0; t <= 16; ++t) expected = expected && plane_height(m, t) == 0;
    EXPECT_EQ(ExactPolygon<Pair>(m).stays_in_plane(), expected) << i;
    flat += expected;
  }
  EXPECT_GE(flat, n_motions / 3);
  EXPECT_LT(flat, n_motions / 2);
}

TEST(ExactPolygon, KnowsWhatStaysInOnePlane) {
  compare_planes<VertexTriangle>(600);
  compare_planes<EdgeEdge>(600);
  compare_planes<VertexEdge2d>(600);
}

/// A vertex and a triangle in the plane z = 0: it is in the closed triangle where no two sides see it on two sides.
TEST(ExactPolygon, MeetsWhereTheVertexIsInTheClosedTriangle) {
  std::mt19937 random(23);
  int meets = 0, apart = 0, on_the_border = 0;
  for (int i = 0; i < 600; ++i) {
    PairMotion<VertexTriangle> m = random_motion<VertexTriangle>(random);
    for (std::size_t k = 0; k < 4; ++k) m.x0[k][2] = m.x1[k][2] = 0;
    const ExactPolygon<VertexTriangle> exact(m);
    EXPECT_TRUE(exact.stays_in_plane());
    for (int t = 0; t <= eighths; ++t) {
      const Long3 a = corner_at(m, 0, 2 * t), b = corner_at(m, 1, 2 * t), c = corner_at(m, 2, 2 * t);
      const Long sides[3] = {cross(a, b)[2], cross(b, c)[2], cross(c, a)[2]};
      if (sides[0] + sides[1] + sides[2] == 0) continue;  // the triangle has no area
      const auto [low, high] = std::minmax_element(std::begin(sides), std::end(sides));
      const bool expected = *low >= 0 || *high <= 0;
      EXPECT_EQ(exact.meets_at(TimeSpan::one / eighths * t), expected) << i << " " << t;
      ++(expected ? meets : apart);
      on_the_border += expected && *low * *high == 0;
    }
  }
  EXPECT_GT(meets, 500);
  EXPECT_GT(apart, 500);
  EXPECT_GT(on_the_border, 20);
}

/// The same motion further away and in other units: 2^-40 of it, and 2^20 units off.
TEST(ExactPolygon, NoUnitAndNoPlaceChangesAProof) {
  std::mt19937 random(9);
  int proven = 0;
  for (int i = 0; i < 400; ++i) {
    const PairMotion<EdgeEdge> m = random_motion<EdgeEdge>(random);
    PairMotion<EdgeEdge> other = m;
    for (std::size_t k = 0; k < 4; ++k) {
      other.x0[k] = 0x1p-40 * (m.x0[k] + Vec3d::Constant(0x1p20));
      other.x1[k] = 0x1p-40 * (m.x1[k] + Vec3d::Constant(0x1p20));
    }
    const Vec3d n(0, 0, 1);  // 0x1p-40 is a power of two: every product keeps its sign
    const bool found = ExactPolygon<EdgeEdge>(m).proves_passage(n, {});
    EXPECT_EQ(ExactPolygon<EdgeEdge>(other).proves_passage(0x1p-30 * n, {}), found) << i;
    EXPECT_EQ(ExactPolygon<EdgeEdge>(m).any_separates({}), ExactPolygon<EdgeEdge>(other).any_separates({}))
        << i;
    proven += found;
  }
  EXPECT_GT(proven, 10);
}

/// What is separated on a span is proven to pass in none of its parts, seen along any direction.
TEST(ExactPolygon, NothingIsBothSeparatedAndPassing) {
  std::mt19937 random(3);
  int separated = 0, passing = 0;
  for (int i = 0; i < 600; ++i) {
    PairMotion<VertexTriangle> m = random_motion<VertexTriangle>(random);
    if (i % 3 == 0) m.x1[0][2] = 4;
    const MovingPolygon<VertexTriangle> polygon(m);
    const ExactPolygon<VertexTriangle> exact(m);
    const bool found = exact.any_separates({});
    EXPECT_GE(found, polygon.any_separates({})) << i << ": floating point proves no more";
    bool passes = false;
    for (int begin = 0; begin < eighths; ++begin) {
      for (const Vec3d& n : {polygon.normal(TimeSpan::one / eighths * begin), Vec3d(0, 0, 1)})
        passes = passes || exact.proves_passage(n, span_of(begin, eighths)) ||
                 exact.proves_passage(n, span_of(begin, begin + 1));
    }
    EXPECT_FALSE(found && passes) << i;
    separated += found, passing += passes;
  }
  EXPECT_GT(separated, 100);
  EXPECT_GT(passing, 30);
}

}  // namespace
}  // namespace bb::audit::exact_polygon_test
