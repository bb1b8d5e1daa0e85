// Broad phase by the boxes of the swept primitives, then one verdict a pair.
#include "core/audit/motion_audit.hpp"

#include <algorithm>

#include "core/audit/box_tree.hpp"
#include "core/audit/obstacle_tally.hpp"
#include "core/audit/pair_verdict.hpp"
#include "core/audit/rigid_reach.hpp"
#include "core/audit/surface_edges.hpp"
#include "core/audit/tally.hpp"

namespace bb::audit {
namespace {

class MotionJudge {
 public:
  MotionJudge(const AuditMesh& mesh, const std::vector<int>& vertices, const Positions& x0,
              const Positions& x1, double tolerance)
      : mesh_(mesh), vertices_(vertices), x0_(x0), x1_(x1), tolerance_(tolerance), reach_(mesh, x0, x1) {}

  MotionAudit vertex_triangle() const {
    return against_vertices<VertexTriangle>(mesh_.triangles, PairKind::vertex_triangle);
  }
  MotionAudit vertex_edge_2d() const {
    return against_vertices<VertexEdge2d>(mesh_.edges, PairKind::vertex_edge_2d);
  }

  MotionAudit edge_edge() const {
    const std::vector<int> edges = reach_.active(mesh_.edges);
    const BoxTree tree(boxes(mesh_.edges, edges));
    MotionAudit out = tally_over<MotionAudit>(edges.size(), [&](std::size_t i, MotionAudit& sum) {
      const int e = edges[i];
      const auto a = mesh_.edges.col(e);
      tree.query(box(a), [&](int found) {
        const int f = edges[static_cast<std::size_t>(found)];
        if (f <= e) return;
        const auto b = mesh_.edges.col(f);
        if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) return;
        pair<EdgeEdge>({a[0], a[1], b[0], b[1]}, {PairKind::edge_edge, e, f}, sum);
      });
    });
    out.queries += reach_.n_asked(mesh_.edges);
    return out;
  }

 private:
  template <class Pair, class Ids>
  MotionAudit against_vertices(const Ids& all, PairKind kind) const {
    const std::vector<int> primitives = reach_.active(all);
    const BoxTree tree(boxes(all, primitives));
    const long against = all.cols() > 0;
    return tally_over<MotionAudit>(vertices_.size(), [&](std::size_t i, MotionAudit& sum) {
      const int v = vertices_[i];
      sum.queries += against && mesh_.judged.asks(v);
      const Eigen::Matrix<int, 1, 1> alone(v);
      if (!reach_.may_meet_others(alone)) return;
      tree.query(box(alone), [&](int found) {
        const int f = primitives[static_cast<std::size_t>(found)];
        const auto ids = all.col(f);
        if (std::find(ids.begin(), ids.end(), v) != ids.end()) return;
        if (mesh_.planar && !mesh_.opposite.empty() && mesh_.opposite[static_cast<std::size_t>(f)] == v)
          return;
        std::array<int, Pair::n_points> points{v};
        std::copy(ids.begin(), ids.end(), points.begin() + 1);
        pair<Pair>(points, {kind, v, f}, sum);
      });
    });
  }

  template <class Pair>
  void pair(const std::array<int, Pair::n_points>& ids, const PairName& name, MotionAudit& sum) const {
    if (std::none_of(ids.begin(), ids.end(), [this](int v) { return moves(v); })) return;
    if (mesh_.common_rigid_body(ids) >= 0 || !mesh_.judged.of_vertices(ids.front(), ids.back())) return;
    PairMotion<Pair> motion;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      motion.x0[k] = x0_.col(ids[k]).template head<Pair::dim>();
      motion.x1[k] = x1_.col(ids[k]).template head<Pair::dim>();
    }
    ++sum.pairs;
    const Verdict verdict = judge(motion, tolerance_);
    if (verdict == Verdict::certified) {
      ++sum.certified;
      return;
    }
    if (mesh_.all_prescribed(ids)) {  // the solver moves none of its vertices
      PairName fault = name;
      fault.proven = verdict == Verdict::violation;
      ++sum.scene_faults;
      keep_first(sum.first_fault, fault);
      return;
    }
    if (verdict == Verdict::unproven) {  // no offender: nothing was shown of this pair
      ++sum.unproven;
      return;
    }
    ++sum.violations;
    keep_first(sum.first_bad, name);
  }

  bool moves(int v) const { return x0_.col(v) != x1_.col(v); }

  template <class Ids>
  Box box(const Ids& ids) const {
    Box b;
    for (int v : ids) b.add(x0_.col(v)), b.add(x1_.col(v));
    if (mesh_.planar) b.lo[2] = b.hi[2] = 0.0;
    return b;
  }
  template <class Ids>
  std::vector<Box> boxes(const Ids& primitives, const std::vector<int>& of) const {
    std::vector<Box> out(of.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = box(primitives.col(of[i]));
    return out;
  }

  const AuditMesh& mesh_;
  const std::vector<int>& vertices_;
  const Positions &x0_, &x1_;
  double tolerance_;
  RigidReach reach_;
};

}  // namespace

void MotionAudit::merge(const MotionAudit& other) {
  pairs += other.pairs, certified += other.certified, violations += other.violations,
      unproven += other.unproven;
  queries += other.queries;
  obstacle_judged.add(other.obstacle_judged);
  obstacle_by_vertex += other.obstacle_by_vertex;
  obstacle_unproven += other.obstacle_unproven;
  obstacle_violations += other.obstacle_violations, scene_faults += other.scene_faults;
  finite = finite && other.finite;
  keep_first(first_bad, other.first_bad);
  keep_first(first_fault, other.first_fault);
}

MotionAudit audit_motion(const AuditMesh& mesh, const std::vector<int>& vertices,
                         const ObstaclePrimitives& primitives, const Positions& x0, const Positions& x1,
                         double tolerance) {
  MotionAudit out;
  out.finite = x0.allFinite() && x1.allFinite();
  if (!out.finite) return out;
  const MotionJudge judge(mesh, vertices, x0, x1, tolerance);
  if (mesh.planar) {
    out.merge(judge.vertex_edge_2d());
  } else {
    out.merge(judge.vertex_triangle());
    out.merge(judge.edge_edge());
  }
  if (mesh.obstacles.empty()) return out;
  const ObstacleAudit found = audit_obstacles(mesh, primitives, x0, x1);
  add_obstacles(found, out);
  out.obstacle_unproven = found.unproven;
  return out;
}

MotionAudit audit_motion(const AuditMesh& mesh, const Positions& x0, const Positions& x1, double tolerance) {
  return audit_motion(mesh, colliding_vertices(mesh), obstacle_primitives(mesh), x0, x1, tolerance);
}

}  // namespace bb::audit
