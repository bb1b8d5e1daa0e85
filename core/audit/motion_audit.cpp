// Broad phase by the boxes of the swept primitives, then one verdict a pair.
#include "core/audit/motion_audit.hpp"

#include <algorithm>

#include "core/audit/box_tree.hpp"
#include "core/audit/obstacle_sign.hpp"
#include "core/audit/pair_verdict.hpp"
#include "core/audit/tally.hpp"

namespace bb::audit {
namespace {

class MotionJudge {
 public:
  MotionJudge(const AuditMesh& mesh, const std::vector<int>& vertices, const Positions& x0,
              const Positions& x1, double tolerance)
      : mesh_(mesh), vertices_(vertices), x0_(x0), x1_(x1), tolerance_(tolerance) {}

  MotionAudit vertex_triangle() const {
    return against_vertices<VertexTriangle>(mesh_.triangles, PairKind::vertex_triangle);
  }
  MotionAudit vertex_edge_2d() const {
    return against_vertices<VertexEdge2d>(mesh_.edges, PairKind::vertex_edge_2d);
  }

  MotionAudit edge_edge() const {
    const BoxTree tree(boxes(mesh_.edges));
    return tally_over<MotionAudit>(
        static_cast<std::size_t>(mesh_.edges.cols()), [&](std::size_t i, MotionAudit& sum) {
          const int e = static_cast<int>(i);
          const auto a = mesh_.edges.col(e);
          ++sum.queries;
          tree.query(box(a), [&](int f) {
            if (f <= e) return;
            const auto b = mesh_.edges.col(f);
            if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) return;
            pair<EdgeEdge>({a[0], a[1], b[0], b[1]}, {PairKind::edge_edge, e, f}, sum);
          });
        });
  }

  MotionAudit obstacles() const {
    return tally_over<MotionAudit>(vertices_.size(), [&](std::size_t i, MotionAudit& sum) {
      const int v = vertices_[i];
      if (!moves(v)) return;
      const bool given = mesh_.is_prescribed(v);
      for (std::size_t o = 0; o < mesh_.obstacles.size(); ++o) {
        ++sum.obstacle_queries;
        if (!obstacle_hit(mesh_.obstacles[o], x0_.col(v), x1_.col(v))) continue;
        ++(given ? sum.scene_faults : sum.obstacle_violations);
        keep_first(given ? sum.first_fault : sum.first_bad,
                   PairName{PairKind::vertex_obstacle, v, static_cast<int>(o)});
      }
    });
  }

 private:
  template <class Pair, class Ids>
  MotionAudit against_vertices(const Ids& primitives, PairKind kind) const {
    const BoxTree tree(boxes(primitives));
    const long against = primitives.cols() > 0;
    return tally_over<MotionAudit>(vertices_.size(), [&](std::size_t i, MotionAudit& sum) {
      const int v = vertices_[i];
      sum.queries += against;
      tree.query(box(Eigen::Matrix<int, 1, 1>(v)), [&](int f) {
        const auto ids = primitives.col(f);
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
  std::vector<Box> boxes(const Ids& primitives) const {
    std::vector<Box> out(static_cast<std::size_t>(primitives.cols()));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = box(primitives.col(static_cast<Eigen::Index>(i)));
    return out;
  }

  const AuditMesh& mesh_;
  const std::vector<int>& vertices_;
  const Positions &x0_, &x1_;
  double tolerance_;
};

}  // namespace

void MotionAudit::merge(const MotionAudit& other) {
  pairs += other.pairs, certified += other.certified, violations += other.violations,
      unproven += other.unproven;
  queries += other.queries, obstacle_queries += other.obstacle_queries;
  obstacle_violations += other.obstacle_violations, scene_faults += other.scene_faults;
  finite = finite && other.finite;
  keep_first(first_bad, other.first_bad);
  keep_first(first_fault, other.first_fault);
}

MotionAudit audit_motion(const AuditMesh& mesh, const std::vector<int>& vertices, const Positions& x0,
                         const Positions& x1, double tolerance) {
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
  if (!mesh.obstacles.empty()) out.merge(judge.obstacles());
  return out;
}

}  // namespace bb::audit
