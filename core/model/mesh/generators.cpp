#include "core/model/mesh/generators.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include "core/base/input/memory.hpp"
#include "core/model/mesh/generator_checks.hpp"

namespace bb {
namespace {

TriangleMesh from_points(const std::vector<Vec3d>& points) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.col(static_cast<Eigen::Index>(i)) = points[i];
  return mesh;
}

std::vector<Vec3d> icosahedron_points() {
  const double phi = std::numbers::phi;
  return {{-1, phi, 0},  {1, phi, 0},  {-1, -phi, 0}, {1, -phi, 0}, {0, -1, phi},  {0, 1, phi},
          {0, -1, -phi}, {0, 1, -phi}, {phi, 0, -1},  {phi, 0, 1},  {-phi, 0, -1}, {-phi, 0, 1}};
}
constexpr std::array<std::array<int, 3>, 20> icosahedron_faces = {
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

/// The lattice point (u, v) of the side of a box at `height` along an axis; u, v and axis are right-handed.
std::array<int, 3> on_side(std::size_t axis, int height, int u, int v) {
  std::array<int, 3> point{};
  point[axis] = height;
  point[(axis + 1) % 3] = u;
  point[(axis + 2) % 3] = v;
  return point;
}

}  // namespace

TriangleMesh grid_mesh(int n_x, int n_y, double size_x, double size_y) {
  require_count("grid/n_x", n_x, 2, max_count);
  require_count("grid/n_y", n_y, 2, max_count);
  require_size("grid/size_x_m", size_x);
  require_size("grid/size_y_m", size_y);
  const double quads = (n_x - 1.0) * (n_y - 1.0);
  require_memory("grid", surface_memory(static_cast<double>(n_x) * n_y, 2 * quads));
  std::vector<Vec3d> points;
  for (int j = 0; j < n_y; ++j) {
    for (int i = 0; i < n_x; ++i) {
      points.emplace_back(size_x * (static_cast<double>(i) / (n_x - 1) - 0.5),
                          size_y * (static_cast<double>(j) / (n_y - 1) - 0.5), 0.0);
    }
  }
  TriangleMesh mesh = from_points(points);
  for (int j = 0; j + 1 < n_y; ++j) {
    for (int i = 0; i + 1 < n_x; ++i) {
      const int a = j * n_x + i, b = a + 1, c = a + n_x, d = c + 1;
      mesh.fans.push_back({static_cast<int>(mesh.triangles.size()), 2});
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

TriangleMesh icosphere_mesh(int level, double radius) {
  require_count("icosphere/level", level, 0, 8);
  require_size("icosphere/radius_m", radius);
  std::vector<Vec3d> points = icosahedron_points();
  for (Vec3d& p : points) p.normalize();
  std::vector<std::array<int, 3>> faces(icosahedron_faces.begin(), icosahedron_faces.end());
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<int, int>, int> middle;
    const auto midpoint = [&](int a, int b) {
      const auto [at, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (is_new) {
        points.push_back(
            (points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]).normalized());
      }
      return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  TriangleMesh mesh = from_points(points);
  mesh.vertices *= radius;
  mesh.triangles = std::move(faces);
  return mesh;
}

TriangleMesh cylinder_mesh(int n_around, int n_along, double radius, double length, bool closed) {
  require_count("cylinder/n_around", n_around, 3, max_count);
  require_count("cylinder/n_along", n_along, 1, max_count);
  require_size("cylinder/radius_m", radius);
  require_size("cylinder/length_m", length);
  require_memory("cylinder", surface_memory(n_around * (n_along + 1.0), 2.0 * n_around * n_along));
  std::vector<Vec3d> points;
  for (int j = 0; j <= n_along; ++j) {
    for (int i = 0; i < n_around; ++i) {
      const double angle = 2 * std::numbers::pi * i / n_around;
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                          length * (static_cast<double>(j) / n_along - 0.5));
    }
  }
  const int bottom = static_cast<int>(points.size()), top = bottom + 1;
  if (closed) points.insert(points.end(), {Vec3d(0, 0, -0.5 * length), Vec3d(0, 0, 0.5 * length)});
  TriangleMesh mesh = from_points(points);
  for (int j = 0; j < n_along; ++j) {
    for (int i = 0; i < n_around; ++i) {
      const int a = j * n_around + i, b = j * n_around + (i + 1) % n_around, c = a + n_around,
                d = b + n_around;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  for (int i = 0; closed && i < n_around; ++i) {
    const int next = (i + 1) % n_around, ring = n_along * n_around;
    mesh.triangles.push_back({bottom, next, i});
    mesh.triangles.push_back({top, ring + i, ring + next});
  }
  return mesh;
}

namespace {

/// Half a width of a trunk at a share of its height, in heights: hips, waist, chest, shoulders and neck, joined without a kink.
double half_width(double share) {
  constexpr std::array<std::array<double, 2>, 6> widths = {
      {{0, 0.15}, {0.2, 0.19}, {0.5, 0.135}, {0.76, 0.18}, {0.88, 0.165}, {1, 0.06}}};
  std::size_t k = 1;
  while (k + 1 < widths.size() && share > widths[k][0]) ++k;
  const auto& [from, below] = widths[k - 1];
  const auto& [to, above] = widths[k];
  const double f = (share - from) / (to - from);
  return below + (above - below) * f * f * (3 - 2 * f);
}

}  // namespace

TriangleMesh torso_mesh(int n_around, int n_along, double height) {
  TriangleMesh mesh = cylinder_mesh(n_around, n_along, 1, height, true);
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    const double width = height * half_width(mesh.vertices(2, v) / height + 0.5);
    mesh.vertices(0, v) *= width;
    mesh.vertices(1, v) *= width / 2;
  }
  return mesh;
}

TriangleMesh box_mesh(int n, const Vec3d& size) {
  require_count("box/n", n, 1, 1000);
  for (int k = 0; k < 3; ++k) require_size("box/size_m", size[k]);
  require_memory("box", surface_memory(6.0 * n * n, 12.0 * n * n));
  std::vector<Vec3d> points;
  std::map<std::array<int, 3>, int> index;
  const auto vertex = [&](const std::array<int, 3>& cell) {
    const auto [at, is_new] = index.try_emplace(cell, static_cast<int>(points.size()));
    if (is_new) {
      const Vec3d unit(cell[0], cell[1], cell[2]);
      points.push_back(size.cwiseProduct(unit / n - Vec3d::Constant(0.5)));
    }
    return at->second;
  };
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          const auto corner = [&](int di, int dj) {
            return vertex(on_side(axis, upper ? n : 0, i + di, j + dj));
          };
          const int a = corner(0, 0), b = corner(1, 0), c = corner(0, 1), d = corner(1, 1);
          if (upper) {  // (a, b, d) faces along +axis
            triangles.insert(triangles.end(), {{a, b, d}, {a, d, c}});
          } else {
            triangles.insert(triangles.end(), {{a, d, b}, {a, c, d}});
          }
        }
      }
    }
  }
  TriangleMesh mesh = from_points(points);
  mesh.triangles = std::move(triangles);
  return mesh;
}

TriangleMesh rod_mesh(int n_segments, const Vec3d& from, const Vec3d& to) {
  require_count("rod/n_segments", n_segments, 1, max_count);
  require_size("rod length", (to - from).norm());
  TriangleMesh mesh;
  mesh.vertices.resize(3, n_segments + 1);
  for (int i = 0; i <= n_segments; ++i) {
    mesh.vertices.col(i) = from + (to - from) * (static_cast<double>(i) / n_segments);
    if (i > 0) mesh.segments.push_back({i - 1, i});
  }
  return mesh;
}

TriangleMesh ring_mesh(int n_segments, double radius) {
  require_count("ring/n_segments", n_segments, 3, max_count);
  require_size("ring/radius_m", radius);
  TriangleMesh mesh;
  mesh.vertices.resize(3, n_segments);
  for (int i = 0; i < n_segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / n_segments;
    mesh.vertices.col(i) = radius * Vec3d(std::cos(angle), std::sin(angle), 0);
    mesh.segments.push_back({i, (i + 1) % n_segments});
  }
  return mesh;
}

TriangleMesh helix_mesh(int n_segments, double n_turns, double radius, double pitch) {
  require_count("helix/n_segments", n_segments, 1, max_count);
  require_size("helix/n_turns", n_turns);
  require_size("helix/radius_m", radius);
  require_size("helix/pitch_m", pitch);
  TriangleMesh mesh;
  mesh.vertices.resize(3, n_segments + 1);
  for (int i = 0; i <= n_segments; ++i) {
    const double turned = n_turns * i / n_segments, angle = 2 * std::numbers::pi * turned;
    mesh.vertices.col(i) =
        Vec3d(radius * std::cos(angle), radius * std::sin(angle), pitch * (turned - 0.5 * n_turns));
    if (i > 0) mesh.segments.push_back({i - 1, i});
  }
  return mesh;
}

}  // namespace bb
