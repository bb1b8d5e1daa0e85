// Two sheets in contact, and bodies that are very far from them: what is near must not notice.
#pragma once

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

/// How many triangles are far away, where in the list of bodies, and how far, m.
struct FarBodies {
  enum class Where { none, first, middle, last } where = Where::none;
  int n = 1;
  double distance = 1e8;
};

/// The scene, its motion, and of each of its vertices the number it has without far bodies, -1 for theirs.
struct FarScene {
  Scene scene;
  Positions x1;
  std::vector<int> original;
};

/// Triangles of 0.1 m in all directions, between a third of the distance and all of it; of a group they are within 1 m.
inline void add_far(FarScene& out, const FarBodies& far, bool group) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d(unit(rng), unit(rng), unit(rng)); };
  std::vector<Vec3d> vertices;
  Triangles triangles;
  const Vec3d one = far.distance * Vec3d(0.8, -0.5, 0.3);
  for (int k = 0; k < far.n; ++k) {
    Vec3d centre = point();
    centre =
        group ? Vec3d(one + centre) : Vec3d(far.distance * (0.6 + 0.3 * unit(rng)) * centre.normalized());
    for (int i = 0; i < 3; ++i) vertices.push_back(centre + 0.1 * point());
    triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  add_body(out.scene, "far", vertices, triangles, 0.01);
  out.original.resize(at(out.scene.n_vertices()), -1);
}

/// Two wavy sheets of n x n cells, 6 mm apart with d_hat 10 mm and a thickness, of which the upper one comes down by
/// up to 2 sink (m) and slides; all fall by the same 2 m.
inline FarScene sheets_and_far(int n, double sink, const FarBodies& far, bool group = false) {
  FarScene out;
  const double h = 1.0 / n, offset = 0.001;
  if (far.where == FarBodies::Where::first) add_far(out, far, group);
  for (int layer = 0; layer < 2; ++layer) {
    auto [vertices, triangles] = grid(n, n, h, Vec3d(0.3 * h * layer, 0.2 * h * layer, 0));
    for (Vec3d& p : vertices) {
      p[2] = 0.1 * std::sin(7 * p[0]) * std::cos(5 * p[1]) + layer * (0.006 + 2 * offset);
    }
    const int first = add_body(out.scene, "sheet", vertices, triangles, 0.01, false, offset);
    for (int v = first; v < out.scene.n_vertices(); ++v) {
      out.original.push_back(layer * static_cast<int>(vertices.size()) + v - first);
    }
    if (layer == 0 && far.where == FarBodies::Where::middle) add_far(out, far, group);
  }
  if (far.where == FarBodies::Where::last) add_far(out, far, group);
  out.x1 = out.scene.x0;
  for (int v = 0; v < out.scene.n_vertices(); ++v) {
    const int number = out.original[at(v)];
    if (number < 0) continue;
    out.x1.col(v) += Vec3d(0.1, 0, -2);
    if (number >= (n + 1) * (n + 1)) out.x1(2, v) -= sink * (1 + std::sin(9 * out.x1(0, v)));
  }
  return out;
}

/// The cases: one far body anywhere in the list, and many, from 1e6 to 1e10 m away.
inline std::vector<FarBodies> far_cases() {
  using Where = FarBodies::Where;
  return {{Where::first, 1, 1e8}, {Where::first, 1, 1e10}, {Where::middle, 1, 1e8}, {Where::last, 1, 1e6},
          {Where::last, 1, 1e10}, {Where::first, 40, 1e8}, {Where::last, 40, 1e10}};
}

}  // namespace bb::test
