// Triangles, rods and points near balls and bars, and their gap by sampling, for the tests of obstacles.
#pragma once

#include <algorithm>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

inline Obstacle round_obstacle(ObstacleKind kind, const Vec3d& point, double radius,
                               const Vec3d& axis = Vec3d::UnitZ()) {
  Obstacle o;
  o.name = kind == ObstacleKind::sphere ? "ball" : "bar";
  o.kind = kind;
  o.point = point;
  o.radius = radius;
  o.axis = axis;
  return o;
}

/// Gap of a point of space, m: by the formula of a distance, with nothing of the code under test.
inline double gap_of_point(const Obstacle& o, const Vec3d& x) {
  const Vec3d q = x - o.point;
  const double rho = o.kind == ObstacleKind::sphere ? q.norm() : q.cross(o.axis).norm();
  return rho - o.radius;
}

/// Least gap of a triangle, an edge or a point (1 to 3 columns): the distance to a centre or a line is convex, so that a
/// grid whose best cell is divided again and again comes to it. m, without thickness.
inline double least_gap(const Obstacle& o, const Eigen::Matrix3Xd& corners) {
  const Eigen::Index n = corners.cols();
  const Vec3d a = corners.col(0), u = n > 1 ? Vec3d(corners.col(1) - a) : Vec3d(Vec3d::Zero()),
              v = n > 2 ? Vec3d(corners.col(2) - a) : Vec3d(Vec3d::Zero());
  double best = std::numeric_limits<double>::infinity(), s0 = 0.5, t0 = 0.5, half = 0.5;
  for (int level = 0; level < 60; ++level, half *= 0.6) {
    double s_best = s0, t_best = t0;
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const double s = std::clamp(s0 + half * i / 4, 0.0, 1.0);
        const double t = n > 2 ? std::clamp(t0 + half * j / 4, 0.0, 1.0 - s) : 0.0;
        const double gap = gap_of_point(o, Vec3d(a + s * u + t * v));
        if (gap < best) best = gap, s_best = s, t_best = t;
      }
    }
    s0 = s_best, t0 = t_best;
  }
  return best;
}

inline double thickness(const Scene& scene, int vertex) { return scene.offset[at(vertex)]; }

/// Least gap of the whole surface at x, thickness taken off, m.
inline double least_gap(const Scene& scene, const Positions& x) {
  double least = std::numeric_limits<double>::infinity();
  const auto add = [&](const auto& vertices) {
    Eigen::Matrix3Xd corners(3, static_cast<Eigen::Index>(vertices.size()));
    for (std::size_t k = 0; k < vertices.size(); ++k)
      corners.col(static_cast<Eigen::Index>(k)) = x.col(vertices[k]);
    for (const Obstacle& o : scene.obstacles)
      least = std::min(least, least_gap(o, corners) - thickness(scene, vertices[0]));
  };
  for (const auto& t : scene.surface_triangles) add(t);
  for (const auto& e : scene.surface_edges) add(e);
  for (const int v : scene.surface_vertices) add(std::array{v});
  return least;
}

/// Loose triangles round a ball and round a bar, a rod by each and a point by each; thick for odd seeds. All gaps are
/// between 0 and the activation distance. Every fifth vertex is given.
inline Scene around_obstacles(unsigned seed) {
  constexpr double d_hat = 0.08;
  const double offset = seed % 2 == 1 ? 0.02 : 0;
  const Vec3d axis = Vec3d(1, 2, 2) / 3.0, ball(0.3, -0.2, 0.1), bar(6.1, 0.2, -0.3);
  Scene scene;
  add_tangent_triangles(scene, "on ball", ball, 0.5, Vec3d::Zero(), d_hat, seed, offset);
  add_tangent_triangles(scene, "on bar", bar, 0.4, axis, d_hat, seed, offset);
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int side = 0; side < 2; ++side) {
    const Vec3d centre = side == 0 ? ball : bar, n = axis.unitOrthogonal(), u = axis.cross(n);
    const Vec3d foot = centre + n * ((side == 0 ? 0.5 : 0.4) + offset + 0.04);
    const Vec3d half = 0.4 * (u + 0.5 * unit(rng) * axis);
    const int first =
        add_body(scene, side == 0 ? "rod by ball" : "rod by bar",
                 {Vec3d(foot - half), Vec3d(foot + half), Vec3d(foot + 2 * half)}, {}, d_hat, false, offset);
    scene.surface_edges.push_back({first, first + 1});
    scene.surface_edges.push_back({first + 1, first + 2});
    add_body(scene, side == 0 ? "point by ball" : "point by bar",
             {Vec3d(centre - n * ((side == 0 ? 0.5 : 0.4) + offset + 0.05))}, {}, d_hat, false, offset);
  }
  scene.motions.push_back({});
  for (int v = 0; v < scene.n_vertices(); v += 5) scene.pins.push_back({v, 0});
  scene.obstacles = {round_obstacle(ObstacleKind::sphere, ball, 0.5),
                     round_obstacle(ObstacleKind::cylinder, bar, 0.4, axis)};
  return scene;
}

/// Triangle t of a scene alone, all of it free.
inline Scene one_triangle_of(const Scene& whole, std::size_t t) {
  Scene scene = whole;
  const std::array<int, 3> corners = whole.surface_triangles[t];
  scene.surface_triangles = {corners};
  scene.surface_edges.clear();
  scene.surface_vertices = {corners[0], corners[1], corners[2]};
  scene.pins.clear();
  return scene;
}

}  // namespace bb::test
