#include "core/model/mesh/strand_generators.hpp"

#include <cmath>
#include <numbers>

#include "core/base/input/memory.hpp"
#include "core/model/mesh/generator_checks.hpp"

namespace bb {
namespace {

constexpr double pi = std::numbers::pi;

/// Lone edges from each of `n` vertices behind `first` to the next, and from the last to the first where the strand is closed.
void add_strand(int first, int n, bool closed, TriangleMesh& mesh) {
  for (int i = 0; i + 1 < n; ++i) mesh.segments.push_back({first + i, first + i + 1});
  if (closed) mesh.segments.push_back({first + n - 1, first});
}

Vec3d long_trefoil(double t, double lift) {
  return {t * t * t - 3 * t, t * t * (t * t - 4), lift * t * (t * t * t * t - 10)};
}
/// In the x-y plane, where it vanishes nowhere: the roots of both derivatives differ.
Vec3d long_trefoil_tangent(double t) { return {3 * t * t - 3, t * (4 * t * t - 8), 0}; }

/// n parameters between -limit and limit at equal arc lengths of the curve.
std::vector<double> equal_lengths(int n, double limit, double lift) {
  const int parts = 200 * n;
  const auto at = [&](int k) { return limit * (2.0 * k / parts - 1); };
  std::vector<double> length(static_cast<std::size_t>(parts) + 1, 0);
  for (int k = 1; k <= parts; ++k) {
    length[static_cast<std::size_t>(k)] = length[static_cast<std::size_t>(k) - 1] +
                                          (long_trefoil(at(k), lift) - long_trefoil(at(k - 1), lift)).norm();
  }
  std::vector<double> out;
  int k = 0;
  for (int i = 0; i < n; ++i) {
    const double wanted = length.back() * i / (n - 1);
    while (k < parts && length[static_cast<std::size_t>(k)] < wanted) ++k;
    out.push_back(at(k));
  }
  return out;
}

}  // namespace

TriangleMesh woven_tube_mesh(const WovenTube& tube) {
  require_count("woven_tube/n_axial", tube.n_axial, 4, max_count);
  if (tube.n_axial % 2 != 0)
    throw ConfigError("woven_tube/n_axial", fmt::format("{}", tube.n_axial), "an even number");
  require_count("woven_tube/n_along", tube.n_along, 2, max_count);
  require_count("woven_tube/n_rings", tube.n_rings, 1, max_count);
  require_size("woven_tube/radius_m", tube.radius);
  require_size("woven_tube/length_m", tube.length);
  require_size("woven_tube/amplitude_m", tube.amplitude);
  const double n = static_cast<double>(tube.n_axial) * (tube.n_along + 3.0 * tube.n_rings);
  require_memory("woven_tube", {vertex_memory(n)});
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(n));
  int at = 0;
  for (int i = 0; i < tube.n_axial; ++i) {
    const double angle = 2 * pi * i / tube.n_axial;
    add_strand(at, tube.n_along, false, mesh);
    for (int k = 0; k < tube.n_along; ++k) {
      mesh.vertices.col(at++) = Vec3d(tube.radius * std::cos(angle), tube.radius * std::sin(angle),
                                      tube.length * (static_cast<double>(k) / (tube.n_along - 1) - 0.5));
    }
  }
  const int n_around = 3 * tube.n_axial;
  for (int i = 1; i <= tube.n_rings; ++i) {
    const double z = tube.length * (static_cast<double>(i) / (tube.n_rings + 1) - 0.5);
    add_strand(at, n_around, true, mesh);
    for (int k = 0; k < n_around; ++k) {
      const double angle = 2 * pi * k / n_around;
      const double swing = tube.amplitude * std::cos(0.5 * tube.n_axial * angle);
      const double radius = tube.radius + (i % 2 == 0 ? swing : -swing);
      mesh.vertices.col(at++) = Vec3d(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  return mesh;
}

TriangleMesh knit_mesh(const Knit& knit) {
  require_count("knit/n_rows", knit.n_rows, 1, max_count);
  require_count("knit/n_loops", knit.n_loops, 1, max_count);
  require_count("knit/n_per_loop", knit.n_per_loop, 8, 1000);
  require_size("knit/loop_m", knit.loop);
  require_size("knit/row_m", knit.row);
  require_size("knit/depth_m", knit.depth);
  const int n_along = knit.n_loops * knit.n_per_loop;
  require_memory("knit", {vertex_memory(static_cast<double>(knit.n_rows) * n_along)});
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(knit.n_rows) * n_along);
  int at = 0;
  for (int row = 0; row < knit.n_rows; ++row) {
    add_strand(at, n_along, false, mesh);
    for (int j = 0; j < n_along; ++j) {
      const double t = 2 * pi * j / knit.n_per_loop;
      mesh.vertices.col(at++) = Vec3d(
          knit.loop *
              (knit.n_loops * (static_cast<double>(j) / (n_along - 1) - 0.5) - 0.25 * std::sin(2 * t)),
          knit.row * (row - 0.5 * (knit.n_rows - 1) + 0.85 * std::sin(t)), knit.depth * std::cos(2 * t));
    }
  }
  return mesh;
}

TriangleMesh knotted_strip_mesh(const KnottedStrip& strip) {
  constexpr double limit = 2.2;  // the crossings are at |t| < 1.9
  require_count("knotted_strip/n_along", strip.n_along, 8, max_count);
  require_count("knotted_strip/n_across", strip.n_across, 2, max_count);
  require_size("knotted_strip/length_m", strip.length);
  require_size("knotted_strip/width_m", strip.width);
  require_size("knotted_strip/lift", strip.lift);
  const double n = static_cast<double>(strip.n_along) * strip.n_across;
  require_memory("knotted_strip", surface_memory(n, 2 * n));
  const double scale = 0.5 * strip.length / long_trefoil(limit, strip.lift).x();
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(n));
  int at = 0;
  for (const double t : equal_lengths(strip.n_along, limit, strip.lift)) {
    const Vec3d across = Vec3d::UnitZ().cross(long_trefoil_tangent(t)).normalized();
    for (int j = 0; j < strip.n_across; ++j) {
      mesh.vertices.col(at++) = scale * long_trefoil(t, strip.lift) +
                                strip.width * (static_cast<double>(j) / (strip.n_across - 1) - 0.5) * across;
    }
  }
  for (int i = 0; i + 1 < strip.n_along; ++i) {
    for (int j = 0; j + 1 < strip.n_across; ++j) {
      const int a = i * strip.n_across + j, b = a + 1, c = a + strip.n_across, d = c + 1;
      mesh.triangles.push_back({a, c, d});
      mesh.triangles.push_back({a, d, b});
    }
  }
  return mesh;
}

TriangleMesh cone_mesh(int n_around, int n_rings, int n_base, double height, double radius) {
  require_count("cone/n_around", n_around, 3, max_count);
  require_count("cone/n_rings", n_rings, 1, max_count);
  require_count("cone/n_base", n_base, 0, max_count);
  require_size("cone/height_m", height);
  require_size("cone/radius_m", radius);
  const int n_all = n_rings + n_base;
  require_memory("cone", surface_memory(2.0 + static_cast<double>(n_around) * n_all, 2.0 * n_around * n_all));
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 + static_cast<Eigen::Index>(n_around) * n_all);
  mesh.vertices.col(0).setZero();
  const int centre = 1 + n_around * n_all;
  mesh.vertices.col(centre) = Vec3d(0, 0, -height);
  for (int k = 0; k < n_all; ++k) {
    const double along = std::pow(std::min(k + 1, n_rings) / static_cast<double>(n_rings), 2);
    const double wide = k < n_rings ? along : (n_all - k) / (n_base + 1.0);
    for (int i = 0; i < n_around; ++i) {
      const double angle = 2 * pi * i / n_around;
      mesh.vertices.col(1 + k * n_around + i) =
          Vec3d(radius * wide * std::cos(angle), radius * wide * std::sin(angle), -height * along);
    }
  }
  const auto ring = [&](int k, int i) { return 1 + k * n_around + i % n_around; };
  for (int i = 0; i < n_around; ++i) {
    mesh.triangles.push_back({0, ring(0, i), ring(0, i + 1)});
    for (int k = 0; k + 1 < n_all; ++k) {
      mesh.triangles.push_back({ring(k, i), ring(k + 1, i), ring(k + 1, i + 1)});
      mesh.triangles.push_back({ring(k, i), ring(k + 1, i + 1), ring(k, i + 1)});
    }
    mesh.triangles.push_back({centre, ring(n_all - 1, i + 1), ring(n_all - 1, i)});
  }
  return mesh;
}

}  // namespace bb
