// Scenes with rods: edges without triangles.
#pragma once

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

/// A straight rod from a point along a vector. Returns its first vertex.
inline int add_rod(Scene& scene, const Vec3d& from, const Vec3d& along, int n_segments, double d_hat,
                   double offset = 0, bool given = false) {
  std::vector<Vec3d> vertices;
  for (int i = 0; i <= n_segments; ++i)
    vertices.push_back(from + (static_cast<double>(i) / n_segments) * along);
  const int first = add_body(scene, "rod", vertices, {}, d_hat, given, offset);
  for (int i = 0; i < n_segments; ++i) scene.surface_edges.push_back({first + i, first + i + 1});
  return first;
}

/// A sheet, rods that are about parallel to its sides and to each other, one of them given, and loose points.
inline Scene rods_and_sheet(unsigned seed, double d_hat) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d(unit(rng), unit(rng), unit(rng)); };
  Scene scene;
  const auto [vertices, triangles] = grid(4, 4, 0.1);
  add_body(scene, "sheet", vertices, triangles, d_hat, false, 0.001);
  for (int k = 0; k < 6; ++k) {
    const Vec3d along = (k % 2 ? Vec3d(0.5, 0, 0) : Vec3d(0, 0.6, 0)) + (k < 3 ? 0.0 : 0.02) * point();
    add_rod(scene, Vec3d(0.02 * k, 0.02 * k, 0.012 * (k + 1)) + 0.03 * point(), along, 1 + k % 3, d_hat,
            k % 2 ? 0.002 : 0, k == 5);
  }
  std::vector<Vec3d> loose;
  for (int k = 0; k < 10; ++k) loose.push_back(Vec3d(0.2, 0.2, 0.05) + 0.1 * point());
  add_body(scene, "points", loose, {}, d_hat);
  return scene;
}

}  // namespace bb::test
