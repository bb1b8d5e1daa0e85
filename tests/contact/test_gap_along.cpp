// Gaps along straight motions to second order: against differences of the gaps of rows, and by hand.
#include <gtest/gtest.h>

#include "tests/contact/obstacle_scenes.hpp"

namespace bb::test::gap_along_test {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

TEST(GapAlong, SaysWhenHalfOfTheGapIsGoneAndWhatTheEndMisses) {
  const GapAlong falls{-1, 0}, rolls{0, 2}, both{-0.3, 0.5}, opens{0.3, 0.5}, flies{-1, -0.5}, rises{1, 0};
  EXPECT_DOUBLE_EQ(falls.half_time(0.4), 0.2);
  EXPECT_DOUBLE_EQ(rolls.half_time(0.04), 0.1);
  for (const GapAlong& gap : {falls, rolls, both, opens}) {
    const double d = 0.04, t = gap.half_time(d);
    EXPECT_NEAR(d + t * gap.slope - t * t * gap.loss, d / 2, 1e-15);
  }
  EXPECT_DOUBLE_EQ(flies.half_time(0.1), 0.1 / (1 + std::sqrt(0.9)));
  EXPECT_EQ(flies.half_time(2), never);  // turns before it is there
  EXPECT_EQ(rises.half_time(0.1), never);
  EXPECT_FALSE(falls.curved(0.4));
  EXPECT_TRUE(rolls.curved(0.04));
  EXPECT_FALSE(rises.curved(0.1));
  EXPECT_FALSE(both.curved(0.04));  // 0.3 t is most of it
  EXPECT_TRUE(both.curved(10));
  EXPECT_DOUBLE_EQ(rolls.missing(0.04), 2);
  EXPECT_DOUBLE_EQ(opens.missing(0.04), 0.5);         // what the slope opens is kept
  EXPECT_DOUBLE_EQ(both.missing(0.04), 0.76 + 0.02);  // the slope would end beyond contact: half of the gap
  EXPECT_EQ(flies.missing(2), 0);
  EXPECT_EQ(rolls.half_time(-0.1), 0);  // no gap at all
  EXPECT_FALSE(rolls.curved(-0.1));
  // a gap of 1e-12 m under a motion of 1 m
  EXPECT_NEAR((GapAlong{-1, 1e-3}.half_time(1e-12)), 5e-13, 1e-24);
  EXPECT_NEAR((GapAlong{1, 1e-3}.half_time(1e-12)), 1e3, 1e-6);
}

/// What row r misses along dx by the gaps that it has at x + h dx and x - h dx; NaN where it is not the same row there.
double missing_of(const ContactTable& rows, std::size_t r, const std::array<Rows, 2>& beside, double h) {
  double d[2];
  for (const std::size_t side : {0, 1}) {
    const ContactTable& there = beside[side].table;
    const auto found = std::lower_bound(there.pair.begin(), there.pair.end(), rows.pair[r]);
    if (found == there.pair.end() || *found != rows.pair[r]) return std::nan("");
    const auto k = static_cast<std::size_t>(found - there.pair.begin());
    if (there.key(k) != rows.key(r) || there.kind[k] != rows.kind[r]) return std::nan("");
    d[side] = there.d[k];
  }
  const GapAlong gap{(d[0] - d[1]) / (2 * h), (2 * rows.d[r] - d[0] - d[1]) / (2 * h * h)};
  return gap.missing(rows.d[r]);
}

/// The force of row r alone.
Positions force_of(ContactTable rows, std::size_t r, const Positions& x, const Positions& dx) {
  const double d2b = rows.d2b[r];
  std::fill(rows.d2b.begin(), rows.d2b.end(), 0.0);
  rows.d2b[r] = d2b;
  Positions force = Positions::Zero(3, x.cols());
  add_curvature_correction(rows, x, dx, force);
  return force;
}

TEST(GapAlong, OfEveryRowIsThatOfItsGap) {
  std::map<ContactKind, int> seen, missed;
  const auto compare = [&](const Scene& scene, unsigned seed) {
    ContactSystem contacts(scene, {Mollifier::none});
    Rows rows = rows_at(contacts, scene.x0);
    evaluate(rows.table, 3.5, TestShape::cubic);
    Positions dx = random_motion(Positions::Zero(3, scene.n_vertices()), 0.2, seed);
    for (const Pin& pin : scene.pins) dx.col(pin.vertex).setZero();
    constexpr double h = 1e-4;
    const std::array<Rows, 2> beside{rows_at(contacts, scene.x0 + h * dx),
                                     rows_at(contacts, scene.x0 - h * dx)};
    for (std::size_t r = 0; r < rows.table.size(); ++r) {
      if (rows.table.d[r] < 0.005) continue;
      const double expected = missing_of(rows.table, r, beside, h);
      if (std::isnan(expected)) continue;
      const Positions force = force_of(rows.table, r, scene.x0, dx);
      const double push = 3.5 * rows.table.d2b[r] * expected;
      const double weight = Vec<double, 4>::Map(&rows.table.weight[4 * r]).norm();
      EXPECT_NEAR(force.norm(), push * weight, 1e-4 * (push * weight + rows.table.d2b[r] * 0.1)) << r;
      ++seen[rows.table.kind[r]];
      missed[rows.table.kind[r]] += push > 0;
    }
  };
  for (unsigned seed = 1; seed <= 3; ++seed) {
    compare(around_obstacles(seed), seed);
    Scene loose;
    for (const unsigned body : {0U, 1U}) {
      const auto [vertices, triangles] = soup(40, 0.25, seed + 10 * body);
      add_body(loose, body == 0 ? "a" : "b", vertices, triangles, 0.1);
    }
    compare(loose, seed);
  }
  for (const ContactKind kind :
       {ContactKind::point_edge, ContactKind::point_triangle, ContactKind::edge_edge, ContactKind::obstacle,
        ContactKind::obstacle_edge, ContactKind::obstacle_triangle}) {
    EXPECT_GT(seen[kind], 3) << int(kind);
    EXPECT_GT(missed[kind], 0) << int(kind);
  }
}

/// An edge above the top of a disk of radius 1, d away, its ends at x = -0.1 and 0.3.
Scene edge_on_disk(double d) {
  Scene scene;
  add_body(scene, "edge", {Vec3d(-0.1, 1 + d, 0), Vec3d(0.3, 1 + d, 0)}, {}, 0.01);
  scene.surface_edges = {{0, 1}};
  scene.planar = true;
  scene.obstacles = {round_obstacle(ObstacleKind::sphere, Vec3d::Zero(), 1)};
  return scene;
}

TEST(HoldTimes, NameCurvatureWhereAnEdgeRolls) {
  const double d = 1e-6;
  const Scene scene = edge_on_disk(d);
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, scene.x0);
  ASSERT_EQ(rows.table.size(), 1U);
  evaluate(rows.table, 1);
  const auto held = [&](const Vec3d& first, const Vec3d& second, Positions* force = nullptr) {
    Positions dx(3, 2), none = Positions::Zero(3, 2);
    dx.col(0) = first, dx.col(1) = second;
    return add_curvature_correction(rows.table, scene.x0, dx, force ? *force : none);
  };
  // it turns by s about the foot, at a quarter of its length: by s^2/2 it comes nearer
  const double s = 0.02;
  Positions force = Positions::Zero(3, 2);
  const HoldTimes rolls = held(Vec3d(0, 0.1 * s, 0), Vec3d(0, -0.3 * s, 0), &force);
  EXPECT_NEAR(rolls.curved, std::sqrt(d / 2 / (s * s / 2)), 1e-5 * rolls.curved);
  EXPECT_EQ(rolls.straight, never);
  EXPECT_TRUE(rolls.by_curvature(rolls.curved));
  EXPECT_FALSE(rolls.by_curvature(rolls.curved / 3));  // something without a row is earlier
  EXPECT_NEAR(force(1, 0), 2 * 0.75 * s * s / 2, 1e-5 * force(1, 0));
  EXPECT_NEAR(force(1, 1), force(1, 0) / 3, 1e-12);
  EXPECT_EQ(force(0, 0), 0);
  // it falls
  const HoldTimes falls = held(Vec3d(0, -s, 0), Vec3d(0, -s, 0));
  EXPECT_NEAR(falls.straight, d / 2 / s, 1e-5 * falls.straight);
  EXPECT_FALSE(falls.by_curvature(1));
  // it slides along itself
  const HoldTimes slides = held(Vec3d(s, 0, 0), Vec3d(s, 0, 0));
  EXPECT_EQ(slides.curved, never);
  EXPECT_EQ(slides.straight, never);
}

}  // namespace
}  // namespace bb::test::gap_along_test
