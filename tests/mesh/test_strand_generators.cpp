// Woven tube, knit, knotted strip and cone: counts, lengths, and that what should not touch does not.
#include <gtest/gtest.h>

#include <cmath>

#include "core/math/error.hpp"
#include "core/model/mesh/strand_generators.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb::mesh::strand_generators_test {
namespace {

/// Of two segments, by sampling both: fine enough to decide which of two strands is above.
double distance(const TriangleMesh& mesh, const std::array<int, 2>& a, const std::array<int, 2>& b) {
  double least = 1e300;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const Vec3d p =
          mesh.vertices.col(a[0]) + i / 20.0 * (mesh.vertices.col(a[1]) - mesh.vertices.col(a[0]));
      const Vec3d q =
          mesh.vertices.col(b[0]) + j / 20.0 * (mesh.vertices.col(b[1]) - mesh.vertices.col(b[0]));
      least = std::min(least, (p - q).norm());
    }
  }
  return least;
}

/// Smallest distance between segments of different strands; `of` numbers the strand of a vertex.
template <class Strand>
double between_strands(const TriangleMesh& mesh, Strand of) {
  double least = 1e300;
  for (std::size_t i = 0; i < mesh.segments.size(); ++i) {
    for (std::size_t j = i + 1; j < mesh.segments.size(); ++j) {
      if (of(mesh.segments[i][0]) == of(mesh.segments[j][0])) continue;
      least = std::min(least, distance(mesh, mesh.segments[i], mesh.segments[j]));
    }
  }
  return least;
}

TEST(woven_tube_mesh, has_the_counts_of_the_published_scenes) {
  const TriangleMesh mesh = woven_tube_mesh({148, 256, 175, 0.5, 2.5, 4.8e-3});
  EXPECT_EQ(mesh.n_vertices(), 115588);
  EXPECT_EQ(mesh.segments.size(), 115440u);
}

TEST(woven_tube_mesh, rings_pass_over_and_under_without_touching) {
  const WovenTube tube{12, 24, 6, 0.0405, 0.1, 4.8e-3};
  const TriangleMesh mesh = woven_tube_mesh(tube);
  const int n_strands = tube.n_axial * tube.n_along;
  const double least = between_strands(mesh, [&](int v) {
    return v < n_strands ? v / tube.n_along : tube.n_axial + (v - n_strands) / (3 * tube.n_axial);
  });
  EXPECT_GT(least, 4.0e-3);  // the sum of the offsets of the scene
  EXPECT_LE(least, tube.amplitude + 1e-9);
  // at the angle of the first strand the first ring is inside, the second outside
  EXPECT_NEAR(mesh.vertices.col(n_strands).head<2>().norm(), tube.radius - tube.amplitude, 1e-12);
  EXPECT_NEAR(mesh.vertices.col(n_strands + 3 * tube.n_axial).head<2>().norm(), tube.radius + tube.amplitude,
              1e-12);
  // and at the second strand the other way round
  EXPECT_NEAR(mesh.vertices.col(n_strands + 3).head<2>().norm(), tube.radius + tube.amplitude, 1e-12);
}

TEST(knit_mesh, strands_hook_without_touching) {
  const Knit knit{3, 3, 20, 1.0 / 26, 1.0 / 52, 3.9e-3};
  const TriangleMesh mesh = knit_mesh(knit);
  EXPECT_EQ(mesh.n_vertices(), 180);
  EXPECT_EQ(mesh.segments.size(), 177u);
  const double least = between_strands(mesh, [](int v) { return v / 60; });
  EXPECT_GT(least, 4.6e-3);  // the sum of the offsets of the scene
  EXPECT_LT(least, 3 * 4.6e-3);
  double top = -1, bottom = 1;  // a row reaches into the loops of the next
  for (int v = 0; v < 60; ++v) top = std::max(top, mesh.vertices(1, v));
  for (int v = 60; v < 120; ++v) bottom = std::min(bottom, mesh.vertices(1, v));
  EXPECT_GT(top, bottom);
}

TEST(knotted_strip_mesh, is_a_strip_from_end_to_end_that_crosses_itself_three_times) {
  const KnottedStrip strip{200, 3, 1, 0.02, 0.1};
  const TriangleMesh mesh = knotted_strip_mesh(strip);
  EXPECT_EQ(mesh.n_vertices(), 600);
  EXPECT_EQ(mesh.triangles.size(), 2u * 199 * 2);
  EXPECT_NEAR(mesh.vertices(0, 1), -0.5, 1e-12);
  EXPECT_NEAR(mesh.vertices(0, 598), 0.5, 1e-12);
  int crossings = 0;
  for (int i = 0; i + 1 < 200; ++i) {
    const double length = (mesh.vertices.col(3 * i + 4) - mesh.vertices.col(3 * i + 1)).norm();
    EXPECT_NEAR(length, 0.0216, 0.004) << i;  // equal parts of the centre line, 4.3 m long
    for (int j = i + 2; j + 1 < 200; ++j) {
      const Vec2d a = mesh.vertices.col(3 * i + 1).head<2>(), b = mesh.vertices.col(3 * i + 4).head<2>();
      const Vec2d c = mesh.vertices.col(3 * j + 1).head<2>(), d = mesh.vertices.col(3 * j + 4).head<2>();
      const auto side = [](const Vec2d& p, const Vec2d& q, const Vec2d& r) {
        return (q - p).x() * (r - p).y() - (q - p).y() * (r - p).x() > 0;
      };
      if (side(a, b, c) == side(a, b, d) || side(c, d, a) == side(c, d, b)) continue;
      ++crossings;
      const double apart = std::abs(mesh.vertices(2, 3 * i + 1) - mesh.vertices(2, 3 * j + 1));
      EXPECT_GT(apart, 0.02);
    }
  }
  EXPECT_EQ(crossings, 3);
}

TEST(cone_mesh, is_closed_and_oriented_outwards) {
  const TriangleMesh mesh = cone_mesh(40, 63, 11, 1, 0.2);
  EXPECT_EQ(mesh.n_vertices(), 2962);  // the cone of the scene needle
  EXPECT_EQ(mesh.triangles.size(), 5920u);
  EXPECT_TRUE(boundary_edges(mesh.triangles).empty());
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    volume += mesh.vertices.col(t[0]).dot(mesh.vertices.col(t[1]).cross(mesh.vertices.col(t[2]))) / 6;
  }
  EXPECT_NEAR(volume, 3.14159265 * 0.04 / 3, 3e-4);
  EXPECT_EQ(mesh.vertices.col(0).norm(), 0);
  EXPECT_NEAR(mesh.vertices.row(2).minCoeff(), -1, 1e-15);
}

TEST(strand_generators, refuse_what_makes_no_mesh) {
  EXPECT_THROW(woven_tube_mesh({13, 24, 6, 1, 1, 0.1}), ConfigError);
  EXPECT_THROW(woven_tube_mesh({12, 1, 6, 1, 1, 0.1}), ConfigError);
  EXPECT_THROW(knit_mesh({0, 1, 20, 1, 1, 1}), ConfigError);
  EXPECT_THROW(knit_mesh({1, 1, 20, 1, 1, -1}), ConfigError);
  EXPECT_THROW(knotted_strip_mesh({7, 3, 1, 0.02, 0.1}), ConfigError);
  EXPECT_THROW(knotted_strip_mesh({8, 3, std::nan(""), 0.02, 0.1}), ConfigError);
  EXPECT_THROW(cone_mesh(2, 1, 0, 1, 1), ConfigError);
}

}  // namespace
}  // namespace bb::mesh::strand_generators_test
