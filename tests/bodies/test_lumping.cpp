// Ways to split the mass of triangles: closed forms on irregular meshes, and the same sum for all.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/model/bodies/lumping.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/bodies/bodies.hpp"

namespace bb::lumping_test {
namespace {

using namespace test;

constexpr Lumping all_lumpings[] = {Lumping::barycentric, Lumping::mixed_voronoi, Lumping::uniform};

std::vector<double> lumped(const TriangleMesh& mesh, Lumping lumping, double per_area = 1) {
  std::vector<double> out(static_cast<std::size_t>(mesh.n_vertices()), 0.0);
  lump_triangles(mesh, lumping, per_area, [&](int v, double m) { out[static_cast<std::size_t>(v)] += m; });
  return out;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TriangleMesh triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << a, b, c;
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Area of what of a triangle is closer to corner 0 than to the others, counted on a fine grid of points.
double closest_fraction(const TriangleMesh& mesh, int n) {
  long mine = 0, all = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      const double u = (i + 1.0 / 3) / n, v = (j + 1.0 / 3) / n;
      const Vec3d p =
          (1 - u - v) * mesh.vertices.col(0) + u * mesh.vertices.col(1) + v * mesh.vertices.col(2);
      const double d[3] = {(p - mesh.vertices.col(0)).norm(), (p - mesh.vertices.col(1)).norm(),
                           (p - mesh.vertices.col(2)).norm()};
      mine += d[0] < d[1] && d[0] < d[2];
      ++all;
    }
  }
  return static_cast<double>(mine) / static_cast<double>(all);
}

TEST(Lumping, gives_a_corner_of_an_acute_triangle_what_is_closest_to_it) {
  const TriangleMesh mesh = triangle({0, 0, 0}, {1, 0, 0.2}, {0.4, 0.9, -0.1});
  const double area = surface_area(mesh);
  const double mine = lumped(mesh, Lumping::mixed_voronoi)[0] / area;
  EXPECT_NEAR(mine, closest_fraction(mesh, 2000), 2e-3);
  EXPECT_GT(std::abs(mine - 1.0 / 3), 0.02);  // what a third would be
}

TEST(Lumping, halves_an_obtuse_triangle_at_its_obtuse_corner) {
  const TriangleMesh mesh = triangle({0, 0, 0}, {4, 0, 0}, {1, 1, 0});  // obtuse at vertex 2, 2 m^2
  EXPECT_EQ(lumped(mesh, Lumping::mixed_voronoi), (std::vector<double>{0.5, 0.5, 1.0}));
}

TEST(Lumping, gives_a_right_triangle_half_at_the_right_corner_from_either_side) {
  const TriangleMesh mesh = triangle({0, 0, 0}, {3, 0, 0}, {0, 5, 0});
  const std::vector<double> area = lumped(mesh, Lumping::mixed_voronoi);
  EXPECT_NEAR(area[0], 3.75, 1e-14);
  EXPECT_NEAR(area[1], 1.875, 1e-14);
  EXPECT_NEAR(area[2], 1.875, 1e-14);
}

/// A sheet whose rows are squeezed together towards one side, so that its triangles differ; the last vertex is in none.
TriangleMesh irregular() {
  TriangleMesh mesh = grid_mesh(6, 5, 1.5, 1.0);
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    const double x = mesh.vertices(0, v), y = mesh.vertices(1, v);
    mesh.vertices.col(v) += Vec3d(0.1 * std::sin(5 * y + x), 0.15 * x * y, 0.1 * std::sin(3 * x));
  }
  mesh.vertices.conservativeResize(3, mesh.n_vertices() + 1);
  mesh.vertices.col(mesh.n_vertices() - 1) = Vec3d(9, 9, 9);
  return mesh;
}

TEST(Lumping, has_the_same_sum_whatever_the_rule_and_other_parts) {
  const TriangleMesh mesh = irregular();
  const double area = surface_area(mesh);
  for (const Lumping lumping : all_lumpings) {
    const std::vector<double> split = lumped(mesh, lumping, 0.3);
    EXPECT_NEAR(sum(split), 0.3 * area, 1e-14);
    EXPECT_EQ(split.back(), 0) << "a vertex of no triangle";
    for (std::size_t v = 0; v + 1 < split.size(); ++v) EXPECT_GT(split[v], 0) << v;
    for (const Lumping other : all_lumpings) {
      if (other == lumping) continue;
      EXPECT_GT(std::abs(split[7] - lumped(mesh, other, 0.3)[7]), 1e-3 * split[7]);
    }
  }
}

TEST(Lumping, is_a_key_of_the_body_and_solids_and_rods_keep_their_own) {
  BodySpec sheet = cloth("sheet");
  sheet.mesh = irregular();
  sheet.mesh.vertices.conservativeResize(3, sheet.mesh.n_vertices() - 1);
  sheet.material.density = 0.3;
  sheet.material.lumping = Lumping::mixed_voronoi;
  sheet.mesh.segments = {{0, 1}};
  sheet.material.line_density = 2;
  const Scene scene = scene_of({sheet});
  sheet.mesh.segments.clear();
  const std::vector<double> of_triangles = lumped(sheet.mesh, Lumping::mixed_voronoi, 0.3);
  const double length = (sheet.mesh.vertices.col(1) - sheet.mesh.vertices.col(0)).norm();
  EXPECT_NEAR(scene.mass[1], of_triangles[1] + length, 1e-14);
  EXPECT_EQ(scene.mass[7], of_triangles[7]);
}

TEST(Lumping, is_refused_where_there_is_nothing_to_split) {
  BodySpec rod;
  rod.name = "rod";
  rod.mesh = rod_mesh(4, Vec3d(0, 0, 0), Vec3d(2, 0, 0));
  rod.material.line_density = 0.3;
  rod.d_hat = 0.01;
  EXPECT_EQ(complaint({rod}), "");
  rod.material.lumping = Lumping::uniform;
  EXPECT_NE(complaint({rod}).find("/material/lumping: found \"uniform\""), std::string::npos)
      << complaint({rod});
}

}  // namespace
}  // namespace bb::lumping_test
