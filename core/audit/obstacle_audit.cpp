#include "core/audit/obstacle_audit.hpp"

#include <algorithm>
#include <array>

#include "core/audit/obstacle_motion.hpp"
#include "core/audit/obstacle_sign.hpp"
#include "core/audit/surface_edges.hpp"
#include "core/audit/tally.hpp"

namespace bb::audit {
namespace {

template <class Column>
bool wholly_fixed(const AuditMesh& mesh, const Column& ids) {
  return std::all_of(ids.begin(), ids.end(), [&mesh](int v) { return mesh.is_fixed(v); });
}

std::vector<EdgeVertices> sides(const Eigen::Matrix3Xi& triangles) {
  std::vector<EdgeVertices> out;
  out.reserve(static_cast<std::size_t>(triangles.size()));
  for (const auto& t : triangles.colwise()) {
    for (int k = 0; k < 3; ++k) out.push_back(ascending(t[k], t[(k + 1) % 3]));
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// One question a primitive and obstacle: a state is a motion that stands still.
class ObstacleJudge {
 public:
  ObstacleJudge(const AuditMesh& mesh, const Positions& x0, const Positions& x1, bool moving,
                bool lists = false)
      : mesh_(mesh), x0_(x0), x1_(x1), moving_(moving), lists_(lists) {}

  ObstacleAudit all(const ObstaclePrimitives& primitives) const {
    ObstacleAudit out;
    for (int o = 0; o < static_cast<int>(mesh_.obstacles.size()); ++o) {
      const AuditObstacle& obstacle = mesh_.obstacles[static_cast<std::size_t>(o)];
      const PrimitiveLists& p = primitives.of(obstacle);
      const auto vertex = [](int v) { return std::array{v}; };
      if (mesh_.asks_vertices(obstacle)) {
        out.merge(over<1>(p.vertices, PairKind::vertex_obstacle, o, &ObstacleCounts::vertices, vertex));
        continue;
      }
      out.merge(over<1>(p.lone_vertices, PairKind::vertex_obstacle, o, &ObstacleCounts::vertices, vertex));
      out.merge(over<2>(p.lone_edges, PairKind::edge_obstacle, o, &ObstacleCounts::edges, [this](int e) {
        return EdgeVertices{mesh_.edges(0, e), mesh_.edges(1, e)};
      }));
      out.merge(
          over<3>(p.triangles, PairKind::triangle_obstacle, o, &ObstacleCounts::triangles, [this](int t) {
            return std::array{mesh_.triangles(0, t), mesh_.triangles(1, t), mesh_.triangles(2, t)};
          }));
    }
    return out;
  }

 private:
  /// Where an obstacle is at both ends.
  struct Poses {
    AuditObstacle begin, end;
  };
  template <std::size_t N, class Ids>
  ObstacleAudit over(const std::vector<int>& list, PairKind kind, int o, long ObstacleCounts::*count,
                     Ids&& ids_of) const {
    const AuditObstacle& given = mesh_.obstacles[static_cast<std::size_t>(o)];
    const Poses poses{given.in(x0_), given.in(x1_)};
    const bool still = poses.begin.point == poses.end.point;
    return tally_over<ObstacleAudit>(list.size(), [&](std::size_t i, ObstacleAudit& sum) {
      const std::array<int, N> ids = ids_of(list[i]);
      if (!mesh_.judged.at_obstacle(ids[0], o)) return;
      if (moving_ && still && std::none_of(ids.begin(), ids.end(), [this](int v) { return moves(v); }))
        return;
      ++(sum.judged.*count);
      const Verdict verdict = judge_one(poses, ids);
      if (verdict != Verdict::certified) note(verdict, ids, {kind, list[i], o}, poses, sum);
    });
  }

  template <std::size_t N>
  Verdict judge_one(const Poses& o, const std::array<int, N>& ids) const {
    std::array<Vec3d, N> a, b;
    for (std::size_t k = 0; k < N; ++k) a[k] = at(x0_, ids[k]), b[k] = at(x1_, ids[k]);
    bool beyond = false;
    if constexpr (N == 1) {
      beyond = moving_ ? obstacle_hit(o.begin, o.end, a[0], b[0]) : obstacle_side(o.begin, a[0]) < 0;
    } else {
      if (moving_) return judge_past_obstacle<N>(o.begin, o.end, a, b);
      if constexpr (N == 2) beyond = obstacle_hit(o.begin, o.begin, a[0], a[1]);
      if constexpr (N == 3) beyond = obstacle_cuts(o.begin, a[0], a[1], a[2]);
    }
    return beyond ? Verdict::violation : Verdict::certified;
  }

  /// A vertex that is beyond the obstacle itself is named in the place of its primitive, a prescribed one first: it
  /// is the scene's.
  template <std::size_t N>
  void note(Verdict verdict, const std::array<int, N>& ids, PairName name, const Poses& o,
            ObstacleAudit& sum) const {
    int free_vertex = -1, prescribed_vertex = -1;
    for (const int v : ids) {
      if (!obstacle_hit(o.begin, o.end, at(x0_, v), at(x1_, v))) continue;
      int& lowest = mesh_.is_prescribed(v) ? prescribed_vertex : free_vertex;
      lowest = lowest < 0 ? v : std::min(lowest, v);
    }
    name.proven = verdict == Verdict::violation;
    if (const int named = prescribed_vertex >= 0 ? prescribed_vertex : free_vertex; named >= 0) {
      name.kind = PairKind::vertex_obstacle, name.first = named;
    }
    if (lists_) sum.all.push_back(name);
    if (prescribed_vertex >= 0 || mesh_.all_prescribed(ids)) {
      ++sum.scene_faults;
      keep_first(sum.first_fault, name);
    } else if (verdict == Verdict::unproven) {
      ++sum.unproven;
    } else {
      ++sum.violations;
      sum.by_vertex += free_vertex >= 0;
      keep_first(sum.first_bad, name);
    }
  }

  bool moves(int v) const { return x0_.col(v) != x1_.col(v); }
  Vec3d at(const Positions& x, int v) const { return {x(0, v), x(1, v), mesh_.planar ? 0.0 : x(2, v)}; }

  const AuditMesh& mesh_;
  const Positions &x0_, &x1_;
  bool moving_, lists_;
};

}  // namespace

ObstacleCounts ObstaclePrimitives::needed(const AuditMesh& mesh) const {
  ObstacleCounts out;
  for (const AuditObstacle& o : mesh.obstacles) {
    const PrimitiveLists& p = of(o);
    if (mesh.asks_vertices(o)) {
      out.vertices += static_cast<long>(p.vertices.size());
    } else {
      out.add({static_cast<long>(p.lone_vertices.size()), static_cast<long>(p.lone_edges.size()),
               static_cast<long>(p.triangles.size())});
    }
  }
  return out;
}

/// moving: the obstacle comes to what is fixed.
static PrimitiveLists primitive_lists(const AuditMesh& mesh, bool moving) {
  PrimitiveLists out;
  const std::vector<EdgeVertices> of_triangles = sides(mesh.triangles);
  const std::vector<int> colliding = colliding_vertices(mesh);
  const auto n = static_cast<std::size_t>(colliding.empty() ? 0 : colliding.back() + 1);
  const auto n_all = std::max<std::size_t>(
      n, mesh.triangles.size() > 0 ? static_cast<std::size_t>(mesh.triangles.maxCoeff()) + 1 : 0);
  std::vector<char> covered(n_all, 0), beside_free(n_all, 0);
  const auto cover = [&](const auto& ids) {
    const bool judged = moving || !wholly_fixed(mesh, ids);
    for (const int v : ids) {
      covered[static_cast<std::size_t>(v)] = 1;
      if (judged) beside_free[static_cast<std::size_t>(v)] = 1;
    }
    return judged;
  };
  for (int t = 0; t < static_cast<int>(mesh.triangles.cols()); ++t) {
    if (cover(mesh.triangles.col(t))) out.triangles.push_back(t);
  }
  for (int e = 0; e < static_cast<int>(mesh.edges.cols()); ++e) {
    const auto ids = mesh.edges.col(e);
    if (std::binary_search(of_triangles.begin(), of_triangles.end(), ascending(ids[0], ids[1]))) continue;
    if (cover(ids)) out.lone_edges.push_back(e);
  }
  for (const int v : colliding) {
    const auto i = static_cast<std::size_t>(v);
    const bool judged = moving || !mesh.is_fixed(v);
    if (judged || beside_free[i]) out.vertices.push_back(v);
    if (judged && !covered[i]) out.lone_vertices.push_back(v);
  }
  return out;
}

ObstaclePrimitives obstacle_primitives(const AuditMesh& mesh) {
  const auto any = [&mesh](bool moving) {
    return std::any_of(mesh.obstacles.begin(), mesh.obstacles.end(),
                       [moving](const AuditObstacle& o) { return o.moves() == moving; });
  };
  return {any(false) ? primitive_lists(mesh, false) : PrimitiveLists{},
          any(true) ? primitive_lists(mesh, true) : PrimitiveLists{}};
}

void ObstacleAudit::merge(const ObstacleAudit& other) {
  judged.add(other.judged);
  violations += other.violations, by_vertex += other.by_vertex;
  unproven += other.unproven, scene_faults += other.scene_faults;
  keep_first(first_bad, other.first_bad);
  keep_first(first_fault, other.first_fault);
  all.insert(all.end(), other.all.begin(), other.all.end());
}

std::vector<PairName> all_beyond_obstacles(const AuditMesh& mesh, const ObstaclePrimitives& primitives,
                                           const Positions& x) {
  return ObstacleJudge(mesh, x, x, false, true).all(primitives).all;
}

ObstacleAudit audit_obstacles(const AuditMesh& mesh, const ObstaclePrimitives& primitives,
                              const Positions& x) {
  return ObstacleJudge(mesh, x, x, false).all(primitives);
}

ObstacleAudit audit_obstacles(const AuditMesh& mesh, const ObstaclePrimitives& primitives,
                              const Positions& x0, const Positions& x1) {
  return ObstacleJudge(mesh, x0, x1, true).all(primitives);
}

}  // namespace bb::audit
