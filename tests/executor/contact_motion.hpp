// Motions of small scenes on an executor and on the CPU path, side by side.
#pragma once

#include <memory>

#include "core/contact/candidates.hpp"
#include "core/contact/executor/executor_broad_phase.hpp"
#include "core/contact/executor/executor_step_bound.hpp"
#include "core/contact/step_bound.hpp"
#include "core/exec/host_executor.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

inline constexpr StopLevel stop_level{1e-6, 4096};

/// A motion of a scene: the side of the executor.
struct ExecutorMotion {
  Surface surface;
  exec::ExecutorSurface surface_there;
  exec::ExecutorBroadPhase broad_phase;
  exec::ExecutorCandidates candidates;
  exec::Buffer<double> x0, x1;

  ExecutorMotion(exec::Executor& executor, const Scene& scene, const Positions& from, const Positions& to)
      : surface(scene),
        surface_there(executor, scene, surface),
        broad_phase(executor, surface_there, surface, plan_contact(scene)),
        candidates(executor),
        x0(executor, "x0"),
        x1(executor, "x1") {
    move(from, to);
  }
  void move(const Positions& from, const Positions& to) {
    x0.upload({from.data(), static_cast<std::size_t>(from.size())});
    x1.upload({to.data(), static_cast<std::size_t>(to.size())});
  }
  void update() { broad_phase.update(x0, x1, candidates); }
};

inline std::vector<IndexPair> pairs_of(const exec::Buffer<exec::Key>& keys) {
  std::vector<IndexPair> out;
  for (const exec::Key key : keys.download()) {
    out.push_back({static_cast<int>(exec::first_of(key)), static_cast<int>(exec::second_of(key))});
  }
  return out;
}

inline Candidates lists_of(const exec::ExecutorCandidates& c) {
  return {pairs_of(c.point_point),       pairs_of(c.point_edge),
          pairs_of(c.point_triangle),    pairs_of(c.edge_edge),
          pairs_of(c.obstacle),          pairs_of(c.obstacle_edge),
          pairs_of(c.obstacle_triangle), {}};
}

inline std::vector<AnalyticSurface<double>> obstacles_of(const Scene& scene) {
  std::vector<AnalyticSurface<double>> out;
  for (const Obstacle& o : scene.obstacles) out.push_back(analytic_surface<double>(o));
  return out;
}

/// The CPU path.
inline Candidates cpu_candidates(const Scene& scene, const Positions& x0, const Positions& x1) {
  const Surface surface(scene);
  BroadPhase broad_phase(surface, obstacles_of(scene), plan_contact(scene));
  Candidates out;
  broad_phase.update(x0, x1, out);
  return out;
}
inline StepBound cpu_bound(const Scene& scene, const Candidates& candidates, const Positions& x0,
                           const Positions& x1) {
  const Surface surface(scene);
  const auto obstacles = obstacles_of(scene);
  return StepBoundFinder(surface, obstacles, stop_level).find(candidates, x0, x1);
}

inline Obstacle obstacle(ObstacleKind kind, const Vec3d& point, double radius, bool inside = false) {
  Obstacle out;
  out.kind = kind;
  out.point = point;
  out.radius = radius;
  out.inside = inside;
  return out;
}

/// Two soups, one of them given for every third seed, thin and long for every second, offsets, three obstacles.
inline Scene soup_scene(unsigned seed, int n_triangles) {
  Scene scene;
  auto [v1, t1] = soup(n_triangles, 0.25, seed);
  auto [v2, t2] = soup(n_triangles, 0.25, seed + 1000);
  if (seed % 2 == 0) {
    for (auto* v : {&v1, &v2}) {
      for (Vec3d& p : *v) p = p.cwiseProduct(Vec3d(3, 1, 0.02));
    }
  }
  add_body(scene, "a", v1, t1, 0.01, false, seed % 2 ? 0.001 : 0);
  add_body(scene, "b", v2, t2, 0.03, seed % 3 == 0);
  scene.obstacles = {obstacle(ObstacleKind::plane, Vec3d(0, 0, -1.2), 0),
                     obstacle(ObstacleKind::sphere, Vec3d(2, 0, 0), 0.8),
                     obstacle(ObstacleKind::cylinder, Vec3d(0, 0, 0), 2.5, true),
                     obstacle(ObstacleKind::cylinder, Vec3d(0, -2.1, 0), 0.8)};
  return scene;
}

/// Points and triangles on a plane with either kind of planar pairs.
inline Scene planar_scene(PlanarPairs pairs, unsigned seed) {
  Scene scene;
  scene.planar = true;
  scene.planar_pairs = pairs;
  auto [vertices, triangles] = soup(25, 0.15, seed);
  for (Vec3d& p : vertices) p[2] = 0;
  auto [sheet, cells] = grid(4, 4, 0.3);
  add_body(scene, "soup", vertices, {}, 0.03);
  const int first = add_body(scene, "sheet", sheet, {}, 0.03);
  auto& elastic = scene.membranes.emplace_back().triangles;
  elastic = triangles;
  for (const auto& t : cells) elastic.push_back({first + t[0], first + t[1], first + t[2]});
  for (const auto& t : elastic) {
    for (std::size_t k = 0; k < 3; ++k) scene.surface_edges.push_back({t[k], t[(k + 1) % 3]});
  }
  return scene;
}

/// In the plane where the scene is.
inline Positions moved(const Scene& scene, double size, unsigned seed) {
  Positions out = random_motion(scene.x0, size, seed);
  if (scene.planar) out.row(2).setZero();
  for (const Pin& pin : scene.pins) out.col(pin.vertex) = scene.x0.col(pin.vertex);
  return out;
}

}  // namespace bb::test
