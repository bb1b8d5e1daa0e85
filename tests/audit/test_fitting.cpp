// Bodies that fit into each other and touch on all sides: one of them has to shrink or to grow, and which one it is depends
// only on how far the other one goes, not on the order in which they are listed nor on where they are. Their middles are in
// the inner one: sizes change about them.
#include <gtest/gtest.h>

#include <random>

#include "core/audit/audit.hpp"

namespace bb::audit::fitting_test {
namespace {

struct Body {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 3>> triangles;  // space
  std::vector<std::array<int, 2>> edges;      // plane
};

struct Fit {
  AuditMesh mesh;
  Positions x;
};

/// Bodies in this order, moved by `shift`.
Fit together(const std::vector<Body>& bodies, const Vec3d& shift, bool planar) {
  std::vector<std::array<int, 2>> edges;
  std::vector<std::array<int, 3>> triangles;
  std::vector<Vec3d> points;
  for (const Body& body : bodies) {
    const int first = static_cast<int>(points.size());
    points.insert(points.end(), body.points.begin(), body.points.end());
    for (const auto& t : body.triangles) {
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
      for (std::size_t k = 0; k < 3; ++k) edges.push_back({first + t[k], first + t[(k + 1) % 3]});
    }
    for (const auto& e : body.edges) edges.push_back({first + e[0], first + e[1]});
  }
  Fit out;
  out.mesh.planar = planar;
  out.x.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t v = 0; v < points.size(); ++v) out.x.col(static_cast<Eigen::Index>(v)) = points[v] + shift;
  out.mesh.edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t e = 0; e < edges.size(); ++e)
    out.mesh.edges.col(static_cast<Eigen::Index>(e)) << edges[e][0], edges[e][1];
  out.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    out.mesh.triangles.col(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  return out;
}

/// The four upright walls of a box, which hang together; with `lids` its two others as well.
Body box(const Vec3d& half, bool lids) {
  Body out;
  for (int k = 0; k < 8; ++k)
    out.points.emplace_back(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1],
                            k & 4 ? half[2] : -half[2]);
  out.triangles = {{0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  if (lids) out.triangles.insert(out.triangles.end(), {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}});
  return out;
}

void expect_touch(const Fit& fit, const std::string& what) {
  const StateAudit found = audit_state(fit.mesh, fit.x, true);
  EXPECT_EQ(found.crossings, 0) << what;
  EXPECT_GT(found.touches, 0) << what;
  EXPECT_FALSE(found.first_bad) << what;
}
void expect_crossing(const Fit& fit, const std::string& what) {
  const StateAudit found = audit_state(fit.mesh, fit.x, true);
  EXPECT_GT(found.crossings, 0) << what;
  EXPECT_TRUE(found.first_bad) << what;
}

std::string name(double length, bool peg_first) {
  return std::to_string(length) + (peg_first ? ", peg first" : ", tube first");
}

/// A peg in a tube that is longer or shorter than it: the peg shrinks within a long one, and has to be the inner one.
TEST(Fitting, APegTouchesItsTubeHoweverLongItIs) {
  int fits = 0;
  for (const double length : {1.0, 2.0, 3.0, 5.0, 8.0}) {
    for (const bool peg_first : {true, false}) {
      for (const Vec3d& shift : {Vec3d(0, 0, 0), Vec3d(5, -3, 2), Vec3d(-64, 128, 7)}) {
        const Body peg = box({1, 2, 3}, true), tube = box({1, 2, length}, false);
        expect_touch(together(peg_first ? std::vector{peg, tube} : std::vector{tube, peg}, shift, false),
                     name(length, peg_first));
        ++fits;
      }
    }
  }
  EXPECT_EQ(fits, 30);
}

/// A plate across the peg, wider than it, is passed whichever of them changes.
TEST(Fitting, APegThroughAPlateThatFillsTheTubeIsACrossing) {
  int crossings = 0;
  for (const double wide : {1.5, 3.0}) {
    for (const bool peg_first : {true, false}) {
      const Body peg = box({1, 1, 3}, true);
      Body plate;
      plate.points = {Vec3d(-wide, -wide, 1), Vec3d(wide, -wide, 1), Vec3d(wide, wide, 1),
                      Vec3d(-wide, wide, 1)};
      plate.triangles = {{0, 1, 2}, {0, 2, 3}};
      expect_crossing(
          together(peg_first ? std::vector{peg, plate} : std::vector{plate, peg}, Vec3d(3, 1, 2), false),
          name(wide, peg_first));
      ++crossings;
    }
  }
  EXPECT_EQ(crossings, 4);
}

/// A line that runs along all four sides of a square and beyond its first corner, less than the side so that its middle
/// stays in the square; `beyond` < 0 ends before the corner.
Body round_square(double beyond) {
  Body out;
  out.points = {Vec3d(-1, -1 - beyond, 0), Vec3d(-1, 1, 0), Vec3d(1, 1, 0), Vec3d(1, -1, 0),
                Vec3d(-0.5, -1, 0)};
  out.edges = {{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  return out;
}
Body square() {
  Body out;
  out.points = {Vec3d(-1, -1, 0), Vec3d(1, -1, 0), Vec3d(1, 1, 0), Vec3d(-1, 1, 0)};
  out.edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  return out;
}

TEST(Fitting, ASquareTouchesTheLineRoundIt) {
  int fits = 0;
  for (const double beyond : {-0.5, 0.0, 1.0, 1.5}) {
    for (const bool square_first : {true, false}) {
      for (const Vec3d& shift : {Vec3d(0, 0, 0), Vec3d(7, 5, 0), Vec3d(-32, 3, 0)}) {
        const Body line = round_square(beyond);
        expect_touch(
            together(square_first ? std::vector{square(), line} : std::vector{line, square()}, shift, true),
            name(beyond, square_first));
        ++fits;
      }
    }
  }
  EXPECT_EQ(fits, 24);
}

/// Its end goes into the square through a corner: no change of size takes it out.
TEST(Fitting, ALineThatEndsInTheSquareIsACrossing) {
  for (const bool square_first : {true, false}) {
    Body line = round_square(1);
    line.points.push_back(Vec3d(0, 0, 0));
    line.points[4] = Vec3d(-1, -1, 0);
    line.edges.push_back({4, 5});
    line.points.push_back(Vec3d(3, 3, 0));
    line.edges.push_back({5, 6});
    expect_crossing(together(square_first ? std::vector{square(), line} : std::vector{line, square()},
                             Vec3d(2, 1, 0), true),
                    square_first ? "square first" : "line first");
  }
}

}  // namespace
}  // namespace bb::audit::fitting_test
