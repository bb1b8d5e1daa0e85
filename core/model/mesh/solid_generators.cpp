#include "core/model/mesh/solid_generators.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "core/base/input/memory.hpp"
#include "core/model/mesh/generator_checks.hpp"
#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

void require_room(const char* where, double vertices, double tetrahedra) {
  require_memory(where, {vertex_memory(vertices), tetrahedron_memory(tetrahedra)});
}

constexpr int max_cells = 1000;

/// Takes the corners in either orientation.
void add_tetrahedron(std::array<int, 4> corners, TriangleMesh& mesh) {
  if (tetrahedron_volume(mesh.vertices, corners) < 0) std::swap(corners[2], corners[3]);
  mesh.tetrahedra.push_back(corners);
}

/// What is extruded: triangles of a plane.
struct Section {
  std::vector<Vec2d> points;
  std::vector<std::array<int, 3>> triangles;
};

/// A disk of radius 1: six sectors round the centre, in rings.
Section disk_section(int n_radial) {
  Section out;
  out.points.emplace_back(0, 0);
  const auto corner = [](int k) {
    const double angle = k * std::numbers::pi / 3;
    return Vec2d(std::cos(angle), std::sin(angle));
  };
  for (int ring = 1; ring <= n_radial; ++ring) {
    for (int k = 0; k < 6 * ring; ++k) {
      const double along = static_cast<double>(k % ring) / ring;
      const Vec2d side = (1 - along) * corner(k / ring) + along * corner(k / ring + 1);
      out.points.push_back(side.normalized() * ring / n_radial);
    }
  }
  const auto point = [](int ring, int k) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + k % (6 * ring);
  };
  for (int ring = 0; ring < n_radial; ++ring) {
    for (int sector = 0; sector < 6; ++sector) {
      for (int i = 0; i <= ring; ++i) {
        const int inner = sector * ring + i, outer = sector * (ring + 1) + i;
        out.triangles.push_back({point(ring, inner), point(ring + 1, outer), point(ring + 1, outer + 1)});
        if (i == ring) continue;
        out.triangles.push_back({point(ring, inner), point(ring + 1, outer + 1), point(ring, inner + 1)});
      }
    }
  }
  return out;
}

/// `n` layers of prisms between copies of the section, three tetrahedra each; `closed`: the last copy is the first. A wall of a
/// prism is split from its lower vertex of smaller number to the upper one of larger number, whichever prism is split.
TriangleMesh extruded(const Section& section, int n, bool closed,
                      const std::function<Vec3d(const Vec2d&, int)>& place) {
  const int per_layer = static_cast<int>(section.points.size()), copies = closed ? n : n + 1;
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(per_layer) * copies);
  for (int j = 0; j < copies; ++j) {
    for (int p = 0; p < per_layer; ++p) {
      mesh.vertices.col(j * per_layer + p) = place(section.points[static_cast<std::size_t>(p)], j);
    }
  }
  for (int j = 0; j < n; ++j) {
    const int low = j * per_layer, high = (j + 1) % copies * per_layer;
    for (std::array<int, 3> t : section.triangles) {
      std::sort(t.begin(), t.end());
      const auto [a, b, c] = t;
      add_tetrahedron({low + a, low + b, low + c, high + c}, mesh);
      add_tetrahedron({low + a, low + b, high + b, high + c}, mesh);
      add_tetrahedron({low + a, high + a, high + b, high + c}, mesh);
    }
  }
  return mesh;
}

double extruded_vertices(int n_radial, int copies) {
  return (1 + 3.0 * n_radial * (n_radial + 1.0)) * copies;
}

/// The points of a ball by what they are made of: weights of corners of the icosahedron (0 to 11) and of the centre (12).
class BallPoints {
 public:
  BallPoints(int n, double radius) : n_(n), radius_(radius), corners_(icosphere_mesh(0, 1).vertices) {}

  /// Weights of the four `corners`, together n.
  int at(const std::array<int, 4>& corners, const std::array<int, 4>& weights) {
    std::map<int, int> key;
    for (std::size_t k = 0; k < 4; ++k) {
      if (weights[k] > 0) key[corners[k]] = weights[k];
    }
    const auto [found, is_new] = index_.try_emplace(key, static_cast<int>(points_.size()));
    if (is_new) points_.push_back(place(key));
    return found->second;
  }
  Positions positions() const {
    Positions out(3, static_cast<Eigen::Index>(points_.size()));
    for (std::size_t i = 0; i < points_.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = points_[i];
    return out;
  }

 private:
  Vec3d place(const std::map<int, int>& key) const {
    Vec3d sum = Vec3d::Zero();
    int outwards = 0;
    for (const auto& [corner, weight] : key) {
      if (corner == 12) continue;
      sum += weight * corners_.col(corner);
      outwards += weight;
    }
    return outwards == 0 ? sum : Vec3d(radius_ * outwards / n_ * sum.normalized());
  }

  int n_;
  double radius_;
  Positions corners_;
  std::map<std::map<int, int>, int> index_;
  std::vector<Vec3d> points_;
};

/// The n^3 parts of a tetrahedron: those of the cubes with n >= x >= y >= z >= 0, each along a path of three unit steps.
template <class F>
void for_each_part(int n, const F& f) {
  std::array<std::size_t, 3> order{0, 1, 2};
  const auto weights = [n](const std::array<int, 3>& q) {
    return std::array<int, 4>{n - q[0], q[0] - q[1], q[1] - q[2], q[2]};
  };
  do {
    for (int x = 0; x < n; ++x) {
      for (int y = 0; y <= x; ++y) {
        for (int z = 0; z <= y; ++z) {
          std::array<int, 3> q{x, y, z};
          std::array<std::array<int, 4>, 4> path{weights(q)};
          for (std::size_t step = 0; step < 3; ++step) {
            ++q[order[step]];
            path[step + 1] = weights(q);
          }
          const bool inside = std::all_of(path.begin(), path.end(), [](const std::array<int, 4>& w) {
            return *std::min_element(w.begin(), w.end()) >= 0;
          });
          if (inside) f(path);
        }
      }
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

}  // namespace

TriangleMesh solid_box_mesh(const std::array<int, 3>& n, const Vec3d& size) {
  for (const int count : n) require_count("solid_box/n", count, 1, max_cells);
  for (int k = 0; k < 3; ++k) require_size("solid_box/size_m", size[k]);
  require_room("solid_box", (n[0] + 1.0) * (n[1] + 1.0) * (n[2] + 1.0), 6.0 * n[0] * n[1] * n[2]);
  const TriangleMesh grid = grid_mesh(n[0] + 1, n[1] + 1, size[0], size[1]);
  Section section{{}, grid.triangles};
  for (int i = 0; i < grid.n_vertices(); ++i) section.points.emplace_back(grid.vertices.col(i).head<2>());
  return extruded(section, n[2], false, [&](const Vec2d& p, int layer) {
    return Vec3d(p[0], p[1], size[2] * (static_cast<double>(layer) / n[2] - 0.5));
  });
}

TriangleMesh solid_ball_mesh(int n, double radius) {
  require_count("solid_ball/n", n, 1, 200);
  require_size("solid_ball/radius_m", radius);
  require_room("solid_ball", 10.0 / 3 * n * n * n, 20.0 * n * n * n);
  BallPoints points(n, radius);
  std::vector<std::array<int, 4>> tetrahedra;
  for (const auto& [a, b, c] : icosphere_mesh(0, 1).triangles) {
    const std::array<int, 4> corners{12, a, b, c};
    for_each_part(n, [&](const std::array<std::array<int, 4>, 4>& path) {
      std::array<int, 4> tetrahedron{};
      for (std::size_t k = 0; k < 4; ++k) tetrahedron[k] = points.at(corners, path[k]);
      tetrahedra.push_back(tetrahedron);
    });
  }
  TriangleMesh mesh;
  mesh.vertices = points.positions();
  for (const auto& t : tetrahedra) add_tetrahedron(t, mesh);
  return mesh;
}

TriangleMesh solid_cylinder_mesh(int n_radial, int n_along, double radius, double length) {
  require_count("solid_cylinder/n_radial", n_radial, 1, max_cells);
  require_count("solid_cylinder/n_along", n_along, 1, max_cells);
  require_size("solid_cylinder/radius_m", radius);
  require_size("solid_cylinder/length_m", length);
  require_room("solid_cylinder", extruded_vertices(n_radial, n_along + 1),
               18.0 * n_radial * n_radial * n_along);
  return extruded(disk_section(n_radial), n_along, false, [&](const Vec2d& p, int layer) {
    return Vec3d(radius * p[0], radius * p[1], length * (static_cast<double>(layer) / n_along - 0.5));
  });
}

TriangleMesh solid_torus_mesh(int n_radial, int n_around, double wide, double thin) {
  require_count("solid_torus/n_radial", n_radial, 1, max_cells);
  require_count("solid_torus/n_around", n_around, 3, max_cells);
  require_size("solid_torus/thin_radius_m", thin);
  if (!(wide > thin) || !std::isfinite(wide)) {
    throw ConfigError("solid_torus/radius_m", fmt::format("{}", wide),
                      fmt::format("a number > {}, the thin radius", thin));
  }
  require_room("solid_torus", extruded_vertices(n_radial, n_around), 18.0 * n_radial * n_radial * n_around);
  return extruded(disk_section(n_radial), n_around, true, [&](const Vec2d& p, int layer) {
    const double angle = 2 * std::numbers::pi * layer / n_around, reach = wide + thin * p[0];
    return Vec3d(reach * std::cos(angle), reach * std::sin(angle), thin * p[1]);
  });
}

}  // namespace bb
