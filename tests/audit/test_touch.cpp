// Surfaces that meet in degenerate positions: those that pass through each other are crossings, those that only touch are
// touches, whatever vertices lie exactly in the planes of the other.
#include "core/audit/touch.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/audit/audit.hpp"

namespace bb::audit::touch_test {
namespace {

struct Surface {
  AuditMesh mesh;
  Positions x;
};

Surface make(const std::vector<Vec3d>& points, const std::vector<std::array<int, 3>>& triangles) {
  Surface s;
  s.x.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) s.x.col(static_cast<Eigen::Index>(i)) = points[i];
  s.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  std::vector<std::pair<int, int>> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      s.mesh.triangles(static_cast<int>(k), static_cast<int>(t)) = triangles[t][k];
      edges.push_back(std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]));
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  s.mesh.edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t e = 0; e < edges.size(); ++e) {
    s.mesh.edges.col(static_cast<Eigen::Index>(e)) << edges[e].first, edges[e].second;
  }
  return s;
}

Surface both(const Surface& a, const Surface& b) {
  const auto n = static_cast<int>(a.x.cols());
  Surface s;
  s.x.resize(3, a.x.cols() + b.x.cols());
  s.x << a.x, b.x;
  s.mesh.edges.resize(2, a.mesh.edges.cols() + b.mesh.edges.cols());
  s.mesh.edges << a.mesh.edges, (b.mesh.edges.array() + n).matrix();
  s.mesh.triangles.resize(3, a.mesh.triangles.cols() + b.mesh.triangles.cols());
  s.mesh.triangles << a.mesh.triangles, (b.mesh.triangles.array() + n).matrix();
  return s;
}

/// n x n squares from `corner` along u and v, each cut in two.
Surface grid(int n, const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) points.push_back(corner + i * u + j * v);
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      triangles.push_back({a, b, d}), triangles.push_back({a, d, c});
    }
  }
  return make(points, triangles);
}

Surface box(const Vec3d& low, const Vec3d& high) {
  std::vector<Vec3d> p;
  for (int k = 0; k < 8; ++k)
    p.emplace_back(k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]);
  return make(p, {{0, 2, 1},
                  {1, 2, 3},
                  {4, 5, 6},
                  {5, 7, 6},
                  {0, 1, 4},
                  {1, 5, 4},
                  {2, 6, 3},
                  {3, 6, 7},
                  {0, 4, 2},
                  {2, 4, 6},
                  {1, 3, 5},
                  {3, 7, 5}});
}

StateAudit judge(const Surface& s) { return audit_state(s.mesh, s.x, true); }

void expect_crossing(const Surface& s, const char* what) {
  const StateAudit found = judge(s);
  EXPECT_GT(found.crossings, 0) << what;
  EXPECT_TRUE(found.first_bad) << what;
}
void expect_touch(const Surface& s, const char* what) {
  const StateAudit found = judge(s);
  EXPECT_EQ(found.crossings, 0) << what;
  EXPECT_GT(found.touches, 0) << what;
}

TEST(Touch, a_sheet_through_a_sheet_with_a_row_of_vertices_in_its_plane_is_a_crossing) {
  const Surface floor = grid(4, Vec3d(0, 0, 0), Vec3d::UnitX(), Vec3d::UnitY());
  const Surface wall = grid(2, Vec3d(1, 1.5, -1), Vec3d::UnitX(), Vec3d::UnitZ());
  expect_crossing(both(floor, wall), "a row in the plane");
  expect_touch(both(floor, grid(2, Vec3d(1, 1.5, 0), Vec3d::UnitX(), Vec3d::UnitZ())), "stands on it");
}

TEST(Touch, given_sheets_are_named_as_a_fault_of_the_scene) {
  Surface s = both(grid(4, Vec3d::Zero(), Vec3d::UnitX(), Vec3d::UnitY()),
                   grid(2, Vec3d(1, 1.5, -1), Vec3d::UnitX(), Vec3d::UnitZ()));
  s.mesh.prescribed.assign(static_cast<std::size_t>(s.x.cols()), 1);
  Audit audit(s.mesh);
  audit.check_state(s.x, 0);
  EXPECT_GT(audit.ledger().scene_faults, 0);
  EXPECT_EQ(audit.ledger().crossings, 0);
  EXPECT_FALSE(audit.ledger().ok());
  ASSERT_TRUE(audit.ledger().first_fault);
  EXPECT_EQ(audit.ledger().first_fault->kind, PairKind::edge_triangle);
}

TEST(Touch, bodies_that_stand_against_each_other_touch) {
  const Surface ground = box(Vec3d(-2, -2, -1), Vec3d(2, 2, 0));
  expect_touch(both(ground, box(Vec3d(-1, -1, 0), Vec3d(1, 1, 1))), "face in face");
  expect_touch(both(ground, box(Vec3d(-2, -2, 0), Vec3d(2, 2, 1))), "flush on all sides");
  expect_touch(both(ground, box(Vec3d(0, 0, 0), Vec3d(5, 5, 1))), "over the border");
  expect_touch(both(ground, box(Vec3d(2, 2, 0), Vec3d(3, 3, 1))), "corner at corner");
  expect_touch(both(ground, make({Vec3d(0, 0, 0), Vec3d(1, 0, 1), Vec3d(0, 1, 1)}, {{0, 1, 2}})),
               "a tip on a face");
  expect_crossing(both(ground, make({Vec3d(0, 0, 0), Vec3d(1, 0, 1), Vec3d(0, 1, -1)}, {{0, 1, 2}})),
                  "a tip as a hinge");
  expect_crossing(both(ground, box(Vec3d(-1, -1, -0.5), Vec3d(3, 1, 0))),
                  "through a side, its top in the plane");
  expect_touch(both(ground, box(Vec3d(-1, -1, -0.5), Vec3d(1, 1, 0))), "within it, its top in the plane");
}

TEST(Touch, a_peg_that_fills_its_hole_touches) {
  const Surface inner = box(Vec3d(-1, -1, -1), Vec3d(1, 1, 1));
  Surface tube = both(grid(1, Vec3d(-1, -1, -1), Vec3d(2, 0, 0), Vec3d(0, 0, 2)),
                      grid(1, Vec3d(-1, 1, -1), Vec3d(2, 0, 0), Vec3d(0, 0, 2)));
  tube = both(tube, both(grid(1, Vec3d(-1, -1, -1), Vec3d(0, 2, 0), Vec3d(0, 0, 2)),
                         grid(1, Vec3d(1, -1, -1), Vec3d(0, 2, 0), Vec3d(0, 0, 2))));
  expect_touch(both(inner, tube), "four walls");
}

// A sheet that goes deep through another, from below to above and inside of its border, in integers: rows of vertices on
// faces, on edges and on vertices of the other.
TEST(Touch, passages_on_an_integer_grid_are_always_found) {
  std::mt19937 random(21);
  std::uniform_int_distribution<int> shift(2, 4), slope(-1, 1);
  int degenerate = 0, untouched = 0;
  for (int i = 0; i < 200; ++i) {
    const Surface floor = grid(8, Vec3d(0, 0, 0), Vec3d::UnitX(), Vec3d::UnitY());
    const Vec3d up(slope(random), slope(random), 1), along(1, slope(random), 0);
    const Surface wall = grid(2, Vec3d(shift(random), shift(random), 0) - up, along, up);
    const StateAudit found = judge(both(floor, wall));
    ASSERT_GT(found.crossings, 0) << i;
    Surface generic = both(floor, wall);
    generic.x.rightCols(wall.x.cols()).colwise() += Vec3d(0.011, 0.007, 0.013);
    ++(judge(generic).pairs > 0 ? degenerate : untouched);
  }
  EXPECT_EQ(untouched, 0);
  EXPECT_GT(degenerate, 0);
}

// Two triangles that share a side, twice, at random integer points: when a real displacement of one pair takes them
// apart, they only touch.
TEST(Touch, what_a_small_displacement_takes_apart_is_no_crossing) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> c(-1, 1);
  const auto book = [&] {
    const auto point = [&] { return Vec3d(c(random), c(random), c(random)); };
    return make({point(), point(), point(), point()}, {{0, 1, 2}, {0, 2, 3}});
  };
  int touching = 0, crossing = 0;
  for (int i = 0; i < 6000; ++i) {
    const Surface a = book(), b = book();
    bool flat = false;
    for (const Surface* s : {&a, &b}) {
      for (const auto& t : s->mesh.triangles.colwise()) {
        flat = flat || (s->x.col(t[1]) - s->x.col(t[0])).cross(s->x.col(t[2]) - s->x.col(t[0])).isZero();
      }
    }
    const Surface s = both(a, b);
    const StateAudit found = judge(s);
    if (flat || found.touches + found.crossings == 0) continue;
    const auto of_each = [](const StateAudit& f) { return f.touches + f.crossings; };
    const long own = of_each(judge(a)) + of_each(judge(b));
    if (own > 0) continue;
    bool apart = false;
    for (int d = 0; d < 27; ++d) {
      Surface moved = s;
      const Vec3d by(64 * (d % 3 - 1) + 3, 64 * (d / 3 % 3 - 1) + 5, 64 * (d / 9 - 1) + 7);
      moved.x.leftCols(4).colwise() += 0x1p-30 * by;
      const StateAudit after = judge(moved);
      apart = apart || after.crossings + after.touches == 0;
    }
    if (apart) {
      ASSERT_EQ(found.crossings, 0) << i;
    }
    ++(found.crossings > 0 ? crossing : touching);
  }
  EXPECT_GT(touching, 300);
  EXPECT_GT(crossing, 300);
}

AuditMesh lines(int n) {
  AuditMesh mesh;
  mesh.planar = true;
  mesh.edges.resize(2, n);
  for (int e = 0; e < n; ++e) mesh.edges.col(e) << e + (e > 1), e + (e > 1) + 1;  // 0 1, 1 2, 3 4, 4 5, ...
  return mesh;
}

TEST(Touch, planar_lines_that_cross_at_a_vertex) {
  const AuditMesh mesh = lines(4);
  Positions x(3, 6);
  x << -1, 0, 1, 0, 0, 0,  //
      0, 0, 0, -1, 0, 1,   //
      0, 0, 0, 5, 5, 5;    // z plays no part
  EXPECT_GT(audit_state(mesh, x, true).crossings, 0);
  x.block<2, 3>(0, 3) << -1, 0, 1, 1, 0, 1;  // a V that stands on the line
  const StateAudit found = audit_state(mesh, x, true);
  EXPECT_EQ(found.crossings, 0);
  EXPECT_GT(found.touches, 0);
}

}  // namespace
}  // namespace bb::audit::touch_test
