// The classes of a segment and a triangle on hand cases: general, coplanar, degenerate;
// invariance under relabelling.
#include "core/audit/segment_triangle.hpp"

#include <gtest/gtest.h>

#include <random>

namespace bb::audit::segment_triangle_test {
namespace {

constexpr Crossing none = Crossing::none, touch = Crossing::touch, crossing = Crossing::crossing;
const Vec3d A(0, 0, 0), B(4, 0, 0), C(0, 4, 0);

Crossing against(const Vec3d& p, const Vec3d& q) { return segment_triangle(p, q, A, B, C); }

TEST(SegmentTriangle, general_position) {
  EXPECT_EQ(against({1, 1, -1}, {1, 1, 1}), crossing);
  EXPECT_EQ(against({1, 1, 1}, {1, 1, -1}), crossing);
  EXPECT_EQ(against({3, 3, -1}, {3, 3, 1}), none);
  EXPECT_EQ(against({1, 1, 1}, {1, 1, 2}), none);
}

TEST(SegmentTriangle, boundary_contacts_touch) {
  EXPECT_EQ(against({2, 0, -1}, {2, 0, 1}), touch);  // through an edge
  EXPECT_EQ(against({0, 0, -1}, {0, 0, 1}), touch);  // through a corner
  EXPECT_EQ(against({1, 1, 0}, {1, 1, 1}), touch);   // end point inside
  EXPECT_EQ(against({2, 0, 0}, {2, 0, 1}), touch);   // end point on an edge
  EXPECT_EQ(against({3, 3, 0}, {3, 3, 1}), none);    // end point in the plane, outside
}

TEST(SegmentTriangle, coplanar_contacts_touch) {
  EXPECT_EQ(against({-1, 1, 0}, {5, 1, 0}), touch);     // across
  EXPECT_EQ(against({0.5, 0.5, 0}, {1, 1, 0}), touch);  // wholly inside
  EXPECT_EQ(against({-1, 0, 0}, {5, 0, 0}), touch);     // along an edge
  EXPECT_EQ(against({-1, -1, 0}, {0, 0, 0}), touch);    // at a corner
  EXPECT_EQ(against({3, 3, 0}, {5, 5, 0}), none);
  EXPECT_EQ(against({5, 0, 0}, {6, 0, 0}), none);  // on an edge's line, beyond it
}

TEST(SegmentTriangle, degenerate_input_touches_or_misses) {
  EXPECT_EQ(against({1, 1, 0}, {1, 1, 0}), touch);  // a point inside
  EXPECT_EQ(against({1, 1, 1}, {1, 1, 1}), none);
  EXPECT_EQ(against({3, 3, 0}, {3, 3, 0}), none);
  const Vec3d a(0, 0, 0), b(2, 2, 2), c(1, 1, 1);  // a triangle without area
  EXPECT_EQ(segment_triangle({0, 2, 1}, {2, 0, 1}, a, b, c), touch);
  EXPECT_EQ(segment_triangle({0, 2, 1.5}, {2, 0, 1.5}, a, b, c), none);
  EXPECT_EQ(segment_triangle({3, 3, 3}, {4, 4, 4}, a, b, c), none);   // collinear, apart
  EXPECT_EQ(segment_triangle({1, 1, 1}, {4, 4, 4}, a, b, c), touch);  // collinear, overlapping
  EXPECT_EQ(segment_triangle({1, 1, 1}, {1, 1, 1}, c, c, c), touch);  // points
  EXPECT_EQ(segment_triangle({1, 1, 2}, {1, 1, 2}, c, c, c), none);
  EXPECT_EQ(segment_triangle({0, 0, 0}, {2, 2, 2}, c, c, c), touch);
}

TEST(SegmentTriangle, class_does_not_depend_on_labels) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> coordinate(-2, 2);
  const auto point = [&] { return Vec3d(coordinate(random), coordinate(random), coordinate(random)); };
  int seen[3] = {0, 0, 0};
  for (int i = 0; i < 5000; ++i) {
    const Vec3d p = point(), q = point(), a = point(), b = point(), c = point();
    const Crossing first = segment_triangle(p, q, a, b, c);
    ASSERT_EQ(first, segment_triangle(q, p, a, b, c));
    ASSERT_EQ(first, segment_triangle(p, q, b, c, a));
    ASSERT_EQ(first, segment_triangle(p, q, b, a, c));
    ++seen[static_cast<int>(first)];
  }
  for (int n : seen) EXPECT_GT(n, 50);
}

TEST(SegmentSegment2d, classes) {
  EXPECT_EQ(segment_segment_2d({0, 0}, {2, 2}, {0, 2}, {2, 0}), crossing);
  EXPECT_EQ(segment_segment_2d({0, 0}, {2, 2}, {1, 1}, {2, 0}), touch);
  EXPECT_EQ(segment_segment_2d({0, 0}, {2, 0}, {1, 0}, {3, 0}), touch);
  EXPECT_EQ(segment_segment_2d({0, 0}, {2, 0}, {3, 0}, {4, 0}), none);
  EXPECT_EQ(segment_segment_2d({0, 0}, {2, 2}, {2, 1}, {3, 0}), none);
  EXPECT_EQ(segment_segment_2d({1, 1}, {1, 1}, {0, 0}, {2, 2}), touch);
  EXPECT_EQ(segment_segment_2d({1, 1}, {1, 1}, {0, 0}, {2, 1}), none);
}

}  // namespace
}  // namespace bb::audit::segment_triangle_test
