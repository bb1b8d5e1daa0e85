// Broad phase by boxes, then signs.
#include "core/audit/state_audit.hpp"

#include <algorithm>
#include <cmath>

#include "core/audit/box_tree.hpp"
#include "core/audit/obstacle_tally.hpp"
#include "core/audit/predicates.hpp"
#include "core/audit/rigid_reach.hpp"
#include "core/audit/segment_triangle.hpp"
#include "core/audit/tally.hpp"
#include "core/audit/touch.hpp"
#include "core/math/stop_request.hpp"

namespace bb::audit {
namespace {

class StateJudge {
 public:
  StateJudge(const AuditMesh& mesh, const Positions& x, bool include_rigid, bool lists = false)
      : mesh_(mesh), x_(x), reach_(include_rigid ? RigidReach() : RigidReach(mesh, x, x)), lists_(lists) {}

  StateAudit edges_and_triangles() const {
    const std::vector<int> edges = reach_.active(mesh_.edges), triangles = reach_.active(mesh_.triangles);
    const BoxTree tree(boxes(mesh_.triangles, triangles));
    StateAudit out = tally_over<StateAudit>(edges.size(), [&](std::size_t i, StateAudit& sum) {
      tree.query(box(mesh_.edges, edges[i]),
                 [&](int t) { edge_triangle(edges[i], triangles[static_cast<std::size_t>(t)], sum); });
    });
    if (mesh_.triangles.cols() > 0) out.queries += reach_.n_asked(mesh_.edges);
    return out;
  }

  StateAudit boundary_edges() const {
    const std::vector<int> edges = reach_.active(mesh_.edges);
    const BoxTree tree(boxes(mesh_.edges, edges));
    StateAudit out = tally_over<StateAudit>(edges.size(), [&](std::size_t i, StateAudit& sum) {
      tree.query(box(mesh_.edges, edges[i]), [&](int f) {
        const int other = edges[static_cast<std::size_t>(f)];
        if (other > edges[i]) edge_edge_2d(edges[i], other, sum);
      });
    });
    out.queries += reach_.n_asked(mesh_.edges);
    return out;
  }

  StateAudit inversions() const {
    return tally_over<StateAudit>(static_cast<std::size_t>(mesh_.triangles.cols()),
                                  [&](std::size_t i, StateAudit& sum) {
                                    const int t = static_cast<int>(i);
                                    const auto v = mesh_.triangles.col(t);
                                    if (orient2d(flat(v[0]), flat(v[1]), flat(v[2])) > 0) return;
                                    ++sum.inverted;
                                    keep_first(sum.first_bad, PairName{PairKind::inverted, t, t});
                                    if (lists_) sum.all.push_back({PairKind::inverted, t, t});
                                  });
  }

  /// Touching pairs that no displacement takes apart are crossings.
  void decide_touches(StateAudit& out) const {
    const std::vector<PairName> crossing = inseparable(mesh_, x_, out.touching);
    out.touches = static_cast<long>(out.touching.size() - crossing.size());
    out.touching.clear();
    for (const PairName& name : crossing) {
      const auto p = mesh_.edges.col(name.first);
      const bool given = mesh_.planar ? mesh_.all_prescribed(mesh_.edges.col(name.second))
                                      : mesh_.all_prescribed(mesh_.triangles.col(name.second));
      out.add_crossing(name, given && mesh_.all_prescribed(p));
      if (lists_) out.all.push_back(name);
    }
  }

 private:
  template <class A, class B>
  bool exempt(const A& a, const B& b) const {
    for (int v : a) {
      if (std::find(b.begin(), b.end(), v) != b.end()) return true;
    }
    return reach_.skips(a, b);
  }
  Vec2d flat(int v) const { return x_.col(v).head<2>(); }

  template <class Ids>
  Box box(const Ids& primitives, int i) const {
    Box b;
    for (int v : primitives.col(i)) b.add(mesh_.planar ? Vec3d(x_(0, v), x_(1, v), 0.0) : Vec3d(x_.col(v)));
    return b;
  }
  template <class Ids>
  std::vector<Box> boxes(const Ids& primitives, const std::vector<int>& of) const {
    std::vector<Box> out(of.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = box(primitives, of[i]);
    return out;
  }

  void count(Crossing found, const PairName& name, bool prescribed, StateAudit& sum) const {
    ++sum.pairs;
    if (found == Crossing::touch) sum.touching.push_back(name);
    if (found != Crossing::crossing) return;
    sum.add_crossing(name, prescribed);
    if (lists_) sum.all.push_back(name);
  }
  void edge_triangle(int e, int t, StateAudit& sum) const {
    const auto p = mesh_.edges.col(e);
    const auto q = mesh_.triangles.col(t);
    if (exempt(p, q)) return;
    const Crossing found =
        segment_triangle(x_.col(p[0]), x_.col(p[1]), x_.col(q[0]), x_.col(q[1]), x_.col(q[2]));
    const PairName name{PairKind::edge_triangle, e, t};
    count(found, name, mesh_.all_prescribed(p) && mesh_.all_prescribed(q), sum);
    if (found == Crossing::crossing) sum.keep_deeper(name, reach_through(p, q));
  }
  double reach_through(const Eigen::Vector2i& p, const Eigen::Vector3i& q) const {
    const Vec3d normal = (x_.col(q[1]) - x_.col(q[0])).cross(x_.col(q[2]) - x_.col(q[0]));
    const double size = normal.norm();
    if (!(size > 0.0)) return 0.0;
    const auto height = [&](int v) { return std::abs(normal.dot(x_.col(v) - x_.col(q[0]))) / size; };
    return std::min(height(p[0]), height(p[1]));
  }
  void edge_edge_2d(int e, int f, StateAudit& sum) const {
    const auto p = mesh_.edges.col(e), q = mesh_.edges.col(f);
    if (exempt(p, q)) return;
    count(segment_segment_2d(flat(p[0]), flat(p[1]), flat(q[0]), flat(q[1])), {PairKind::edge_edge_2d, e, f},
          mesh_.all_prescribed(p) && mesh_.all_prescribed(q), sum);
  }

  const AuditMesh& mesh_;
  const Positions& x_;
  RigidReach reach_;
  bool lists_;
};

}  // namespace

void StateAudit::add_crossing(const PairName& name, bool prescribed) {
  ++(prescribed ? scene_faults : crossings);
  keep_first(prescribed ? first_fault : first_bad, name);
}

// Of equally deep ones the lower name, so that no order of threads shows.
void StateAudit::keep_deeper(const std::optional<PairName>& name, double depth_m) {
  if (!name) return;
  const bool deeper = !deepest || depth_m > deepest_m || (depth_m == deepest_m && *name < *deepest);
  if (deeper) deepest = name, deepest_m = depth_m;
}

void StateAudit::merge(const StateAudit& other) {
  pairs += other.pairs, queries += other.queries;
  crossings += other.crossings, touches += other.touches;
  inverted += other.inverted, obstacle_violations += other.obstacle_violations;
  scene_faults += other.scene_faults;
  obstacle_judged.add(other.obstacle_judged);
  obstacle_by_vertex += other.obstacle_by_vertex;
  finite = finite && other.finite;
  touching.insert(touching.end(), other.touching.begin(), other.touching.end());
  all.insert(all.end(), other.all.begin(), other.all.end());
  keep_first(first_bad, other.first_bad);
  keep_first(first_fault, other.first_fault);
  keep_deeper(other.deepest, other.deepest_m);
}

StateAudit audit_state(const AuditMesh& mesh, const ObstaclePrimitives& primitives, const Positions& x,
                       bool include_rigid) {
  StateAudit out;
  out.finite = x.allFinite();
  if (!out.finite) return out;
  heed_stop();
  const StateJudge judge(mesh, x, include_rigid);
  heed_stop();
  out.merge(mesh.planar ? judge.boundary_edges() : judge.edges_and_triangles());
  heed_stop();
  judge.decide_touches(out);
  if (mesh.planar && mesh.judged.scope != Scope::at_step_ends) out.merge(judge.inversions());
  if (mesh.obstacles.empty()) return out;
  add_obstacles(audit_obstacles(mesh, primitives, x), out);
  return out;
}

StateAudit audit_state(const AuditMesh& mesh, const Positions& x, bool include_rigid) {
  return audit_state(mesh, obstacle_primitives(mesh), x, include_rigid);
}

std::vector<PairName> all_crossings(const AuditMesh& mesh, const Positions& x) {
  const StateJudge judge(mesh, x, true, true);
  StateAudit out = mesh.planar ? judge.boundary_edges() : judge.edges_and_triangles();
  judge.decide_touches(out);
  if (mesh.planar) out.merge(judge.inversions());
  if (!mesh.obstacles.empty()) {
    const std::vector<PairName> beyond = all_beyond_obstacles(mesh, obstacle_primitives(mesh), x);
    out.all.insert(out.all.end(), beyond.begin(), beyond.end());
  }
  std::sort(out.all.begin(), out.all.end());
  out.all.erase(std::unique(out.all.begin(), out.all.end()), out.all.end());
  return std::move(out.all);
}

}  // namespace bb::audit
