// Scenes with contact of all kinds, on the CPU path and on an executor.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>

#include "core/contact/candidates.hpp"
#include "core/contact/executor/contact_assembly.hpp"
#include "core/contact/executor/row_finder.hpp"
#include "core/exec/host_executor.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test {

using exec::Index;
using exec::Key;

constexpr exec::Order all_orders[] = {exec::Order::threads, exec::Order::forward, exec::Order::reverse,
                                      exec::Order::shuffled, exec::Order::shuffled};

/// Two triangle soups, one of them offset, and two sheets that lie over one another: edges close to parallel. Some
/// vertices are given; obstacles of all kinds pass through, and loose triangles lie on a ball and on a bar.
inline Scene full_scene(unsigned seed) {
  Scene scene;
  const auto [v1, t1] = soup(40, 0.25, seed);
  add_body(scene, "a", v1, t1, 0.08);
  const auto [v2, t2] = soup(40, 0.25, seed + 1);
  add_body(scene, "b", v2, t2, 0.06, false, 0.01);
  for (const double z : {2.0, 2.05}) {
    const auto [vertices, triangles] = grid(3, 3, 0.3, Vec3d(0.01 * z, 0, z));
    add_body(scene, "sheet", vertices, triangles, 0.08);
  }
  const Vec3d axis = Vec3d(1, 2, 2) / 3.0, ball = 6 * axis, bar = 12 * axis;
  const Vec3d along = Vec3d(2, 1, -2) / 3.0;
  add_tangent_triangles(scene, "on ball", ball, 0.5, Vec3d::Zero(), 0.08, seed);
  add_tangent_triangles(scene, "on bar", bar, 0.4, along, 0.08, seed);
  std::mt19937_64 rng(seed);
  for (int v = 0; v < scene.n_vertices(); ++v) {
    scene.mass[at(v)] = 0.5 + 0.1 * static_cast<double>(rng() % 10);
    if (rng() % 7 == 0) scene.pins.push_back({v, 0});
  }
  scene.motions.push_back({});
  const auto obstacle = [&](ObstacleKind kind, const Vec3d& point, double radius, bool inside) {
    scene.obstacles.emplace_back();
    Obstacle& o = scene.obstacles.back();
    o.kind = kind, o.point = point, o.radius = radius, o.inside = inside;
    o.axis = axis;
  };
  obstacle(ObstacleKind::plane, Vec3d(-1, -1, -1) * 0.8, 0, false);
  obstacle(ObstacleKind::sphere, Vec3d(0.4, 0.3, 2.4), 0.34, false);
  obstacle(ObstacleKind::cylinder, Vec3d(0, 0, 0), 2.6, true);
  obstacle(ObstacleKind::sphere, ball, 0.5, false);
  obstacle(ObstacleKind::cylinder, bar, 0.4, false);
  scene.obstacles.back().axis = along;
  return scene;
}

/// Loose vertices and edges in a plane.
inline Scene planar_layers(PlanarPairs pairs, unsigned seed) {
  Scene scene;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3d> vertices;
  for (int v = 0; v < 60; ++v) vertices.push_back(Vec3d(unit(rng), unit(rng), 0));
  add_body(scene, "loose", vertices, {}, 0.2);
  for (int v = 0; v + 1 < 60; v += 2) scene.surface_edges.push_back({v, v + 1});
  for (int v = 0; v < 60; ++v) {
    scene.body[at(v)] = v / 2;
    if (v % 9 == 0) scene.pins.push_back({v, 0});
  }
  scene.motions.push_back({});
  scene.planar = true;
  scene.planar_pairs = pairs;
  return scene;
}

/// The state at which a scene is looked at: its own, shaken a little so that no pair is symmetric.
inline Positions shaken(const Scene& scene) { return random_motion(scene.x0, 0.004, 99); }

inline std::vector<Key> keys(const std::vector<IndexPair>& pairs) {
  std::vector<Key> out;
  for (const IndexPair& p : pairs)
    out.push_back(static_cast<Key>(p.first) << 32 | static_cast<Key>(p.second));
  return out;
}

inline void upload(exec::Buffer<double>& to, const Positions& x) {
  to.upload({x.data(), static_cast<std::size_t>(x.size())});
}

/// A scene in an executor's memory, with its rows at x.
struct OnExecutor {
  OnExecutor(exec::Executor& executor, const Scene& scene, const Positions& state,
             exec::KappaColumns columns = exec::KappaColumns::uniform)
      : surface(scene),
        surface_there(executor, scene, surface),
        candidates(executor),
        x(executor, "positions"),
        rows(executor, columns),
        finder(executor, surface_there, plan_contact(scene).mollifier.needed) {
    find(scene, state, rows);
  }
  void find(const Scene& scene, const Positions& state, exec::ExecutorRows& out) {
    std::vector<AnalyticSurface<double>> obstacles;
    for (const Obstacle& o : scene.obstacles) obstacles.push_back(analytic_surface<double>(o));
    BroadPhase broad_phase(surface, obstacles, plan_contact(scene));
    Candidates c;
    broad_phase.update(state, state, c);
    candidates.point_point.upload(keys(c.point_point));
    candidates.point_edge.upload(keys(c.point_edge));
    candidates.point_triangle.upload(keys(c.point_triangle));
    candidates.edge_edge.upload(keys(c.edge_edge));
    candidates.obstacle.upload(keys(c.obstacle));
    candidates.obstacle_edge.upload(keys(c.obstacle_edge));
    candidates.obstacle_triangle.upload(keys(c.obstacle_triangle));
    upload(x, state);
    finder.find(x, candidates, out);
  }

  const Surface surface;
  exec::ExecutorSurface surface_there;
  exec::ExecutorCandidates candidates;
  exec::Buffer<double> x;
  exec::ExecutorRows rows;
  exec::RowFinder finder;
};

/// A column of a RowView on the host.
template <class T>
std::vector<T> column(const T* data, Index n) {
  return data ? std::vector<T>(data, data + n) : std::vector<T>();
}

/// Every column of the rows, as bytes.
inline std::string bytes_of(exec::ExecutorRows& rows) {
  const exec::RowView v = rows.view();
  std::string out;
  const auto add = [&out](const auto* data, Index n) {
    if (data) out.append(reinterpret_cast<const char*>(data), static_cast<std::size_t>(n) * sizeof(*data));
  };
  add(v.vertex, 4 * v.n), add(v.weight, 4 * v.n), add(v.normal, 3 * v.n), add(v.d, v.n), add(v.d_hat, v.n);
  add(v.pair, v.n), add(v.kind, v.n), add(v.free, v.n), add(v.kappa, v.n), add(v.kappa_before, v.n);
  add(v.per_gap_sq, v.n), add(rows.list.data(), rows.list.size());
  add(&rows.min_gap, 1);
  return out;
}

/// Energy, force and stiffness, too.
inline std::string terms_of(exec::ExecutorRows& rows) {
  const exec::RowView v = rows.view();
  std::string out = bytes_of(rows);
  for (const double* c : {v.energy, v.force, v.stiffness}) {
    out.append(reinterpret_cast<const char*>(c), static_cast<std::size_t>(v.n) * sizeof(double));
  }
  return out;
}

}  // namespace bb::test
