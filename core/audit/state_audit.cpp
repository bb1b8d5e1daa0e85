// Broad phase by boxes, then signs.
#include "core/audit/state_audit.hpp"

#include <algorithm>

#include "core/audit/box_tree.hpp"
#include "core/audit/obstacle_sign.hpp"
#include "core/audit/predicates.hpp"
#include "core/audit/segment_triangle.hpp"
#include "core/audit/tally.hpp"

namespace bb::audit {
namespace {

class StateJudge {
 public:
  StateJudge(const AuditMesh& mesh, const Positions& x, bool include_fixed)
      : mesh_(mesh), x_(x), include_fixed_(include_fixed) {}

  StateAudit edges_and_triangles() const {
    const BoxTree tree(boxes(mesh_.triangles));
    const long against = mesh_.triangles.cols() > 0;
    return tally_over<StateAudit>(static_cast<std::size_t>(mesh_.edges.cols()),
                                  [&](std::size_t i, StateAudit& sum) {
                                    const int e = static_cast<int>(i);
                                    sum.queries += against;
                                    tree.query(box(mesh_.edges, e), [&](int t) { edge_triangle(e, t, sum); });
                                  });
  }

  StateAudit boundary_edges() const {
    const BoxTree tree(boxes(mesh_.edges));
    return tally_over<StateAudit>(static_cast<std::size_t>(mesh_.edges.cols()),
                                  [&](std::size_t i, StateAudit& sum) {
                                    const int e = static_cast<int>(i);
                                    ++sum.queries;
                                    tree.query(box(mesh_.edges, e), [&](int f) {
                                      if (f > e) edge_edge_2d(e, f, sum);
                                    });
                                  });
  }

  StateAudit inversions() const {
    return tally_over<StateAudit>(static_cast<std::size_t>(mesh_.triangles.cols()),
                                  [&](std::size_t i, StateAudit& sum) {
                                    const int t = static_cast<int>(i);
                                    const auto v = mesh_.triangles.col(t);
                                    if (orient2d(flat(v[0]), flat(v[1]), flat(v[2])) > 0) return;
                                    ++sum.inverted;
                                    keep_first(sum.first_bad, PairName{PairKind::inverted, t, t});
                                  });
  }

  StateAudit obstacles(const std::vector<int>& vertices) const {
    return tally_over<StateAudit>(vertices.size(), [&](std::size_t i, StateAudit& sum) {
      const int v = vertices[i];
      if (mesh_.is_fixed(v)) return;
      const bool given = mesh_.is_prescribed(v);
      for (std::size_t o = 0; o < mesh_.obstacles.size(); ++o) {
        ++sum.obstacle_queries;
        if (obstacle_side(mesh_.obstacles[o], x_.col(v)) >= 0) continue;
        ++(given ? sum.scene_faults : sum.obstacle_violations);
        keep_first(given ? sum.first_fault : sum.first_bad,
                   PairName{PairKind::vertex_obstacle, v, static_cast<int>(o)});
      }
    });
  }

 private:
  template <class Column>
  bool wholly_fixed(const Column& ids) const {
    return std::all_of(ids.begin(), ids.end(), [this](int v) { return mesh_.is_fixed(v); });
  }
  template <class A, class B>
  bool exempt(const A& a, const B& b) const {
    for (int v : a) {
      if (std::find(b.begin(), b.end(), v) != b.end()) return true;
    }
    return !include_fixed_ && wholly_fixed(a) && wholly_fixed(b);
  }
  Vec2d flat(int v) const { return x_.col(v).head<2>(); }

  template <class Ids>
  Box box(const Ids& primitives, int i) const {
    Box b;
    for (int v : primitives.col(i)) b.add(mesh_.planar ? Vec3d(x_(0, v), x_(1, v), 0.0) : Vec3d(x_.col(v)));
    return b;
  }
  template <class Ids>
  std::vector<Box> boxes(const Ids& primitives) const {
    std::vector<Box> out(static_cast<std::size_t>(primitives.cols()));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = box(primitives, static_cast<int>(i));
    return out;
  }

  static void count(Crossing found, const PairName& name, bool prescribed, StateAudit& sum) {
    ++sum.pairs;
    if (found == Crossing::none) return;
    const bool crosses = found == Crossing::crossing;
    if (crosses && prescribed) {
      ++sum.scene_faults;
      keep_first(sum.first_fault, name);
      return;
    }
    ++(crosses ? sum.crossings : sum.touches);
    keep_first(crosses ? sum.first_bad : sum.first_touch, name);
  }
  void edge_triangle(int e, int t, StateAudit& sum) const {
    const auto p = mesh_.edges.col(e);
    const auto q = mesh_.triangles.col(t);
    if (exempt(p, q)) return;
    count(segment_triangle(x_.col(p[0]), x_.col(p[1]), x_.col(q[0]), x_.col(q[1]), x_.col(q[2])),
          {PairKind::edge_triangle, e, t}, mesh_.all_prescribed(p) && mesh_.all_prescribed(q), sum);
  }
  void edge_edge_2d(int e, int f, StateAudit& sum) const {
    const auto p = mesh_.edges.col(e), q = mesh_.edges.col(f);
    if (exempt(p, q)) return;
    count(segment_segment_2d(flat(p[0]), flat(p[1]), flat(q[0]), flat(q[1])), {PairKind::edge_edge_2d, e, f},
          mesh_.all_prescribed(p) && mesh_.all_prescribed(q), sum);
  }

  const AuditMesh& mesh_;
  const Positions& x_;
  bool include_fixed_;
};

}  // namespace

void StateAudit::merge(const StateAudit& other) {
  pairs += other.pairs, queries += other.queries, obstacle_queries += other.obstacle_queries;
  crossings += other.crossings, touches += other.touches;
  inverted += other.inverted, obstacle_violations += other.obstacle_violations;
  scene_faults += other.scene_faults;
  finite = finite && other.finite;
  keep_first(first_bad, other.first_bad);
  keep_first(first_touch, other.first_touch);
  keep_first(first_fault, other.first_fault);
}

StateAudit audit_state(const AuditMesh& mesh, const std::vector<int>& vertices, const Positions& x,
                       bool include_fixed) {
  StateAudit out;
  out.finite = x.allFinite();
  if (!out.finite) return out;
  const StateJudge judge(mesh, x, include_fixed);
  out.merge(mesh.planar ? judge.boundary_edges() : judge.edges_and_triangles());
  if (mesh.planar) out.merge(judge.inversions());
  if (!mesh.obstacles.empty()) out.merge(judge.obstacles(vertices));
  return out;
}

std::vector<int> colliding_vertices(const AuditMesh& mesh) {
  std::vector<int> out(mesh.points);
  out.insert(out.end(), mesh.edges.data(), mesh.edges.data() + mesh.edges.size());
  if (!mesh.planar)
    out.insert(out.end(), mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace bb::audit
