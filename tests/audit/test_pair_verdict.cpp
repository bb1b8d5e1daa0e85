// Verdicts of single pairs in motion: hand cases, sliding, ulp gaps, and random motions
// against dense sampling.
#include "core/audit/pair_verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/audit/exact_polygon.hpp"
#include "core/audit/segment_triangle.hpp"

namespace bb::audit::pair_verdict_test {
namespace {

constexpr double tolerance = 1e-9;
using Points4 = std::array<Vec3d, 4>;

Verdict vertex_triangle(const Points4& x0, const Points4& x1) {
  return judge<VertexTriangle>({x0, x1}, tolerance);
}
Verdict edge_edge(const Points4& x0, const Points4& x1) { return judge<EdgeEdge>({x0, x1}, tolerance); }

const Vec3d A(0, 0, 0), B(4, 0, 0), C(0, 4, 0);

Verdict vertex_over_triangle(const Vec3d& p0, const Vec3d& p1) {
  return vertex_triangle({p0, A, B, C}, {p1, A, B, C});
}

TEST(PairVerdict, vertex_through_a_triangle_is_a_violation) {
  EXPECT_EQ(vertex_over_triangle({1, 1, 1}, {1, 1, -1}), Verdict::violation);  // meets at a split of time
  EXPECT_EQ(vertex_over_triangle({1, 1, 1}, {1.3, 0.9, -0.4}), Verdict::violation);
  EXPECT_EQ(vertex_over_triangle({1, 1, 1e-12}, {1, 1, -1e-12}), Verdict::violation);
}

TEST(PairVerdict, vertex_that_stays_or_passes_beside_is_certified) {
  EXPECT_EQ(vertex_over_triangle({1, 1, 1}, {1, 1, 1e-13}), Verdict::certified);
  EXPECT_EQ(vertex_over_triangle({3, 3, 1}, {3, 3, -1}), Verdict::certified);
  EXPECT_EQ(vertex_over_triangle({2 + 1e-9, 2 + 1e-9, 1}, {2 + 1e-9, 2 + 1e-9, -1}), Verdict::certified);
}

TEST(PairVerdict, sliding_at_a_tiny_gap_is_certified) {
  EXPECT_EQ(vertex_over_triangle({-3, 1, 1e-12}, {7, 1, 1e-12}), Verdict::certified);
  const double gap = 1e-12;
  EXPECT_EQ(edge_edge({Vec3d(-5, 0, gap), Vec3d(5, 0, gap), Vec3d(-4, -1, 0), Vec3d(-4, 1, 0)},
                      {Vec3d(-5, 0, gap), Vec3d(5, 0, gap), Vec3d(4, -2, 0), Vec3d(4, 2, 0)}),
            Verdict::certified);
}

/// No direction separates it for long: the spans of time grow as size over gap, to 8000 at 1e-4.
TEST(PairVerdict, a_turning_pair_at_a_small_gap_is_certified) {
  for (const double gap : {1e-2, 1e-3, 1e-4}) {
    const Vec3d n0(0, 0, 1), n1(0, -0.8, 0.6), a(0, 0, 0), b(1, 0, 0), c0(0.5, 1, 0), c1(0.5, 0.6, 0.8);
    const Vec3d m0 = (a + b + c0) / 3 + gap * n0, m1 = (a + b + c1) / 3 + gap * n1;
    EXPECT_EQ(vertex_triangle({m0, a, b, c0}, {m1, a, b, c1}), Verdict::certified) << gap;
  }
}

TEST(PairVerdict, a_gap_of_one_ulp_is_settled_by_integers) {
  const double z = std::nextafter(1.0, 2.0);
  const Vec3d a(0, 0, 1), b(4, 0, 1), c(0, 4, 1);
  EXPECT_EQ(vertex_triangle({Vec3d(1, 1, z), a, b, c}, {Vec3d(1.5, 1, z), a, b, c}), Verdict::certified);
}

TEST(PairVerdict, touching_is_neither_certified_nor_a_passage) {
  EXPECT_EQ(vertex_over_triangle({1, 1, 1}, {1, 1, 0}), Verdict::unproven);
  EXPECT_EQ(vertex_over_triangle({1, 1, 0}, {1, 1, 1}), Verdict::unproven);
  EXPECT_EQ(vertex_over_triangle({0.5, 0.5, 0}, {1, 1, 0}), Verdict::unproven);  // lasting
  EXPECT_EQ(vertex_over_triangle({0, 0, 1}, {0, 0, -1}), Verdict::unproven);     // through a corner
}

struct Judged {
  Verdict verdict;
  Effort effort;
};
template <class Pair>
Judged judged(const PairMotion<Pair>& motion) {
  Effort effort;
  const Verdict verdict = judge(motion, tolerance, &effort);
  return {verdict, effort};
}

/// As two sheets that lie in each other: a vertex on a corner, on a side and in the middle of a triangle that turns and is
/// stretched, and edges that cross or lie on one line. A pair is not split until the cap.
TEST(PairVerdict, a_pair_that_touches_all_the_time_is_settled_after_few_spans) {
  const Vec3d a1(1, 2, 3), b1(4, 2.5, 3.5), c1(1.25, 5, 2);
  const auto at = [](const Vec3d& a, const Vec3d& b, const Vec3d& c, double u, double v) {
    return Vec3d(a + u * (b - a) + v * (c - a));
  };
  const auto seldom = [](const Judged& found) {
    EXPECT_EQ(found.verdict, Verdict::unproven);
    EXPECT_LE(found.effort.exact_spans, 10);
    EXPECT_LE(found.effort.spans, 200);
    EXPECT_GT(found.effort.spans, 0);
  };
  for (const auto& [u, v] : {std::pair(0.0, 0.0), {0.5, 0.0}, {0.25, 0.5}}) {
    seldom(judged<VertexTriangle>({{at(A, B, C, u, v), A, B, C}, {at(a1, b1, c1, u, v), a1, b1, c1}}));
    const Vec3d off0(4, 4, 0), off1 = at(a1, b1, c1, 1, 1);
    seldom(judged<EdgeEdge>({{at(A, B, C, u, 0), off0, A, B}, {at(a1, b1, c1, u, 0), off1, a1, b1}}));
  }
  seldom(judged<EdgeEdge>({{A, B, A, B}, {a1, b1, a1, b1}}));
  seldom(judged<VertexTriangle>({{Vec3d(0.5, 0.5, 0), A, B, C}, {Vec3d(1, 1, 0), A, B, C}}));
  const Vec2d p(0.5, 0), l(0, 0), r(1, 0);
  seldom(judged<VertexEdge2d>({{p, l, r}, {Vec2d(1.5, 2.5), Vec2d(1, 2), Vec2d(2, 3)}}));
}

/// Two parallel rods that turn in one plane: they are apart, and are not looked at in integers for every span.
TEST(PairVerdict, a_pair_in_one_plane_that_stays_apart_is_split_as_any_other) {
  const auto rods = [](double gap, double lift) {
    return PairMotion<EdgeEdge>{{Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, gap, lift), Vec3d(1, gap, 0)},
                                {Vec3d(0, 0, 0), Vec3d(0, 1, 0), Vec3d(-gap, 0, lift), Vec3d(-gap, 1, 0)}};
  };
  const Judged flat = judged(rods(1e-3, 0)), lifted = judged(rods(1e-3, 1e-7));
  EXPECT_EQ(flat.verdict, Verdict::certified);
  EXPECT_EQ(lifted.verdict, Verdict::certified);
  EXPECT_GT(flat.effort.spans, 64);
  EXPECT_EQ(flat.effort.exact_spans, 0);
}

/// In one plane and yet apart: it is split until it is certified. It meets the triangle for a part of the time: it is not.
TEST(PairVerdict, a_pair_in_one_plane_is_certified_where_it_stays_apart) {
  const double out = 2 + 1e-7;
  EXPECT_EQ(vertex_triangle({Vec3d(out, out, 0), A, B, C}, {Vec3d(out - 1, out + 1, 0), A, B, C}),
            Verdict::certified);
  const Judged slides = judged<VertexTriangle>({{Vec3d(-1, 1, 0), A, B, C}, {Vec3d(6, 1.5, 0), A, B, C}});
  EXPECT_EQ(slides.verdict, Verdict::unproven);
  EXPECT_LE(slides.effort.exact_spans, 10);
}

TEST(PairVerdict, edge_through_edge_is_a_violation) {
  const Vec3d a(-1, 0, 0), b(1, 0, 0);
  const auto upright = [](double y, double z) {
    return std::array{Vec3d(0.1, y, z - 1), Vec3d(0.2, y, z + 1)};
  };
  const auto from = upright(1, 0.1), to = upright(-1, 0.3), beside = upright(1, 5);
  EXPECT_EQ(edge_edge({a, b, from[0], from[1]}, {a, b, to[0], to[1]}), Verdict::violation);
  EXPECT_EQ(edge_edge({a, b, from[0], from[1]}, {a, b, beside[0], beside[1]}), Verdict::certified);
}

TEST(PairVerdict, parallel_and_degenerate_edges_are_certified_when_apart) {
  const Vec3d a(0, 0, 0), b(1, 0, 0), up(0, 0, 0.5);
  EXPECT_EQ(edge_edge({a, b, a + up, b + up}, {a, b, a + 1e-6 * up, b + 1e-6 * up}), Verdict::certified);
  EXPECT_EQ(edge_edge({a, a, a + up, a + up}, {a, a, b + up, b + up}), Verdict::certified);
}

TEST(PairVerdict, both_fast_but_together_is_certified) {
  const Vec3d shift(100, -50, 70);
  const Points4 x0{Vec3d(1, 1, 1e-6), A, B, C};
  Points4 x1 = x0;
  for (Vec3d& x : x1) x += shift;
  EXPECT_EQ(vertex_triangle(x0, x1), Verdict::certified);
}

TEST(PairVerdict, planar_vertex_against_edge) {
  const auto moved = [](const Vec2d& p0, const Vec2d& p1) {
    const Vec2d a(0, 0), b(4, 1);
    return judge<VertexEdge2d>({{p0, a, b}, {p1, a, b}}, tolerance);
  };
  EXPECT_EQ(moved({2, 2}, {2, -1}), Verdict::violation);
  EXPECT_EQ(moved({2, 2}, {2, 0.5 + 1e-12}), Verdict::certified);
  EXPECT_EQ(moved({2, 2}, {2, 0.5}), Verdict::unproven);
  EXPECT_EQ(moved({5, 2}, {5, -1}), Verdict::certified);
  EXPECT_EQ(moved({-1, 1e-9}, {5, 1.5}), Verdict::certified);
}

TEST(PairVerdict, passage_proof_needs_opposite_sides_and_the_interior) {
  const PairMotion<VertexTriangle> through{{Vec3d(1, 1, 1), A, B, C}, {Vec3d(1, 1, -1), A, B, C}};
  const PairMotion<VertexTriangle> beside{{Vec3d(3, 3, 1), A, B, C}, {Vec3d(3, 3, -1), A, B, C}};
  EXPECT_TRUE(ExactPolygon<VertexTriangle>(through).proves_passage(Vec3d::UnitZ(), {}));
  EXPECT_FALSE(ExactPolygon<VertexTriangle>(beside).proves_passage(Vec3d::UnitZ(), {}));
  const TimeSpan first_half{0, TimeSpan::one / 2 - 1};
  EXPECT_FALSE(ExactPolygon<VertexTriangle>(through).proves_passage(Vec3d::UnitZ(), first_half));
  EXPECT_TRUE(ExactPolygon<VertexTriangle>(through).any_separates(first_half));
}

/// Smallest |difference| polygon distance seen at n times: from above, by sampling the pair's parameters.
double sampled_gap(const Points4& x0, const Points4& x1, bool edges) {
  double least = 1e300;
  constexpr int n = 16;
  for (int it = 0; it <= n; ++it) {
    Points4 x;
    for (std::size_t k = 0; k < 4; ++k) x[k] = x0[k] + it / double(n) * (x1[k] - x0[k]);
    for (int iu = 0; iu <= n; ++iu) {
      for (int iv = 0; iv <= (edges ? n : n - iu); ++iv) {
        const double u = iu / double(n), v = iv / double(n);
        const Vec3d d = edges ? Vec3d((1 - u) * x[0] + u * x[1] - (1 - v) * x[2] - v * x[3])
                              : Vec3d(x[0] - (1 - u - v) * x[1] - u * x[2] - v * x[3]);
        least = std::min(least, d.norm());
      }
    }
  }
  return least;
}

TEST(PairVerdict, random_motions_agree_with_sampling) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int count[2][3] = {};
  for (int i = 0; i < 600; ++i) {
    const bool edges = i % 2 == 1;
    Points4 x0, x1;
    for (std::size_t k = 0; k < 4; ++k) {
      x0[k] = Vec3d(unit(random), unit(random), unit(random));
      x1[k] = x0[k] + 1.5 * Vec3d(unit(random), unit(random), unit(random));
    }
    const Verdict verdict = edges ? edge_edge(x0, x1) : vertex_triangle(x0, x1);
    const double gap = sampled_gap(x0, x1, edges);
    if (verdict == Verdict::violation) {
      EXPECT_LT(gap, 0.4);  // the spacing of the samples
    }
    if (verdict == Verdict::certified) {
      EXPECT_GT(gap, 0.0);
    }
    ++count[edges][static_cast<int>(verdict)];
  }
  for (const auto& c : count) {
    EXPECT_GT(c[0], 20);
    EXPECT_GT(c[1], 3);
    EXPECT_EQ(c[2], 0);
  }
}

TEST(PairVerdict, every_planted_hit_is_a_violation) {
  std::mt19937 random(22);
  std::uniform_real_distribution<double> unit(-1.0, 1.0), inner(0.15, 0.3);
  const auto point = [&] { return Vec3d(unit(random), unit(random), unit(random)); };
  for (int i = 0; i < 500; ++i) {
    const bool edges = i % 2 == 1;
    Points4 at_hit{point(), point(), point(), point()}, speed{point(), point(), point(), point()}, x0, x1;
    const double u = inner(random), v = inner(random), t = 0.5 + unit(random) * 0.4;
    at_hit[0] = edges ? Vec3d(((1 - v) * at_hit[2] + v * at_hit[3] - u * at_hit[1]) / (1 - u))
                      : Vec3d((1 - u - v) * at_hit[1] + u * at_hit[2] + v * at_hit[3]);
    for (std::size_t k = 0; k < 4; ++k) {
      x0[k] = at_hit[k] - t * speed[k];
      x1[k] = at_hit[k] + (1 - t) * speed[k];
    }
    EXPECT_EQ(edges ? edge_edge(x0, x1) : vertex_triangle(x0, x1), Verdict::violation) << i;
  }
}

}  // namespace
}  // namespace bb::audit::pair_verdict_test
