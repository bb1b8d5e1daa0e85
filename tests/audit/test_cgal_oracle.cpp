// CGAL's exact kernel as oracle of the signs and of the segment-triangle classes: random, near-degenerate and
// integer-grid input. The one file that includes CGAL.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/audit/predicates.hpp"
#include "core/audit/segment_triangle.hpp"

namespace bb::audit::cgal_oracle_test {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using P3 = Kernel::Point_3;

P3 cgal(const Vec3d& p) { return {p[0], p[1], p[2]}; }
Kernel::Point_2 cgal(const Vec2d& p) { return {p[0], p[1]}; }

/// Closed sets meet, by CGAL; degenerate triangles as the union of their sides.
bool oracle_meets(const P3& p, const P3& q, const P3& a, const P3& b, const P3& c) {
  const auto meets_side = [&](const P3& s, const P3& t) {
    if (p == q && s == t) return p == s;
    if (p == q) return Kernel::Segment_3(s, t).has_on(p);
    if (s == t) return Kernel::Segment_3(p, q).has_on(s);
    return CGAL::do_intersect(Kernel::Segment_3(p, q), Kernel::Segment_3(s, t));
  };
  if (CGAL::collinear(a, b, c)) return meets_side(a, b) || meets_side(b, c) || meets_side(c, a);
  const Kernel::Triangle_3 triangle(a, b, c);
  return p == q ? triangle.has_on(p) : CGAL::do_intersect(Kernel::Segment_3(p, q), triangle);
}

/// The definition in words: opposite sides, and the point of the plane strictly inside.
Crossing oracle_class(const Vec3d& p_, const Vec3d& q_, const Vec3d& a_, const Vec3d& b_, const Vec3d& c_) {
  const P3 p = cgal(p_), q = cgal(q_), a = cgal(a_), b = cgal(b_), c = cgal(c_);
  if (!oracle_meets(p, q, a, b, c)) return Crossing::none;
  if (CGAL::collinear(a, b, c)) return Crossing::touch;
  const Kernel::Plane_3 plane(a, b, c);
  if (plane.oriented_side(p) * plane.oriented_side(q) != CGAL::NEGATIVE) return Crossing::touch;
  const auto hit = CGAL::intersection(Kernel::Line_3(p, q), plane);
  const P3 x = boost::get<P3>(*hit);
  const bool on_side = Kernel::Segment_3(a, b).has_on(x) || Kernel::Segment_3(b, c).has_on(x) ||
                       Kernel::Segment_3(c, a).has_on(x);
  return on_side ? Crossing::touch : Crossing::crossing;
}

class Inputs {
 public:
  explicit Inputs(unsigned seed) : random_(seed) {}
  Vec3d anywhere() { return {unit_(random_), unit_(random_), unit_(random_)}; }
  Vec3d on_grid() { return {integer(), integer(), integer()}; }
  /// In the plane of a, b, c to rounding, then moved by ulps.
  Vec3d near_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d p = a + unit_(random_) * (b - a) + unit_(random_) * (c - a);
    return p + 0x1p-53 * on_grid();
  }

 private:
  double integer() { return grid_(random_); }
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  std::uniform_int_distribution<int> grid_{-2, 2};
};

struct Seen {
  int count[3] = {0, 0, 0};
  void expect_all(int least) const {
    for (int n : count) EXPECT_GE(n, least);
  }
};

void expect_signs(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, Seen& seen2, Seen& seen3) {
  const int sign3 = orient3d(a, b, c, d);
  ASSERT_EQ(sign3, static_cast<int>(CGAL::orientation(cgal(a), cgal(b), cgal(c), cgal(d))));
  ++seen3.count[sign3 + 1];
  const Vec2d p = a.head<2>(), q = b.head<2>(), r = c.head<2>();
  const int sign2 = orient2d(p, q, r);
  ASSERT_EQ(sign2, static_cast<int>(CGAL::orientation(cgal(p), cgal(q), cgal(r))));
  ++seen2.count[sign2 + 1];
}

TEST(CgalOracle, orientation_signs) {
  Inputs in(1);
  Seen seen2, seen3;
  for (int i = 0; i < 1500; ++i) {
    const Vec3d a = in.anywhere(), b = in.anywhere(), c = in.anywhere();
    expect_signs(a, b, c, in.anywhere(), seen2, seen3);
    expect_signs(a, b, c, in.near_plane(a, b, c), seen2, seen3);
    expect_signs(in.on_grid(), in.on_grid(), in.on_grid(), in.on_grid(), seen2, seen3);
  }
  seen2.expect_all(100);
  seen3.expect_all(100);
}

void expect_class(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c,
                  Seen& seen) {
  const Crossing found = segment_triangle(p, q, a, b, c);
  ASSERT_EQ(found, oracle_class(p, q, a, b, c))
      << p.transpose() << " | " << q.transpose() << " | " << a.transpose() << " | " << b.transpose() << " | "
      << c.transpose();
  ++seen.count[static_cast<int>(found)];
}

TEST(CgalOracle, segment_triangle_in_general_position) {
  Inputs in(2);
  Seen seen;
  for (int i = 0; i < 2000; ++i) {
    expect_class(in.anywhere(), in.anywhere(), in.anywhere(), in.anywhere(), in.anywhere(), seen);
  }
  EXPECT_GT(seen.count[0], 100);
  EXPECT_GT(seen.count[2], 100);
}

TEST(CgalOracle, segment_triangle_near_degenerate) {
  Inputs in(3);
  Seen seen;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d a = in.anywhere(), b = in.anywhere(), c = in.anywhere(), p = in.anywhere();
    expect_class(in.near_plane(a, b, c), in.near_plane(a, b, c), a, b, c, seen);  // nearly coplanar
    expect_class(in.near_plane(a, b, c), p, a, b, c, seen);  // one end nearly in the plane
    const Vec3d on_edge = a + 0.5 * (b - a);
    expect_class(p, on_edge + (on_edge - p), a, b, c, seen);     // nearly through an edge
    expect_class(p, a + (a - p), a, b, c, seen);                 // nearly through a corner
    expect_class(p, p + 0x1p-53 * in.on_grid(), a, b, p, seen);  // a needle at a corner
  }
  seen.expect_all(50);
}

TEST(CgalOracle, segment_triangle_on_an_integer_grid) {
  Inputs in(4);
  Seen seen;
  for (int i = 0; i < 4000; ++i) {
    expect_class(in.on_grid(), in.on_grid(), in.on_grid(), in.on_grid(), in.on_grid(), seen);
    Vec3d flat[5];
    for (Vec3d& v : flat) v = in.on_grid(), v[2] = v[0] + v[1];  // all five in one plane
    expect_class(flat[0], flat[1], flat[2], flat[3], flat[4], seen);
    const Vec3d a = in.on_grid(), step = in.on_grid();  // triangle without area
    expect_class(in.on_grid(), in.on_grid(), a, a + step, a + 2.0 * step, seen);
  }
  seen.expect_all(100);
}

}  // namespace
}  // namespace bb::audit::cgal_oracle_test
