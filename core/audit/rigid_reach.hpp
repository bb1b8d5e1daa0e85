// What moves as one rigid body cannot cross itself: only what may come near another body, or near a primitive with a free
// vertex, has to be looked at, and of that what the judge has in its scope.
#pragma once

#include <algorithm>
#include <vector>

#include "core/audit/box_tree.hpp"
#include "core/audit/surface.hpp"

namespace bb::audit {

class RigidReach {
 public:
  /// Looks at everything.
  RigidReach() = default;
  /// Of the motion x0 -> x1 (m), or of the state x0 = x1. Cost: O(n).
  RigidReach(const AuditMesh& mesh, const Positions& x0, const Positions& x1)
      : mesh_(&mesh), x0_(&x0), x1_(&x1) {
    for (const int v : mesh.points) add(Eigen::Matrix<int, 1, 1>(v));
    for (const auto& e : mesh.edges.colwise()) add(e);
    if (mesh.planar) return;  // elements are judged for inversion only
    for (const auto& t : mesh.triangles.colwise()) add(t);
  }

  /// False only if every primitive that this one may meet is of its own rigid body, or of a body that is out
  /// of scope with its own.
  template <class Column>
  bool may_meet_others(const Column& ids) const {
    if (!mesh_) return true;
    if (!mesh_->judged.asks(*ids.begin())) return false;
    const int body = mesh_->common_rigid_body(ids);
    if (body < 0) return true;
    const Box mine = box_of(ids);
    if (mine.meets(others_)) return true;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (b != static_cast<std::size_t>(body) && mine.meets(bodies_[b])) return true;
    }
    return false;
  }

  /// The columns of `primitives` that have to be looked at, ascending.
  template <class Ids>
  std::vector<int> active(const Ids& primitives) const {
    std::vector<int> out;
    out.reserve(static_cast<std::size_t>(primitives.cols()));
    for (int i = 0; i < static_cast<int>(primitives.cols()); ++i) {
      if (may_meet_others(primitives.col(i))) out.push_back(i);
    }
    return out;
  }

  /// True if the two may be skipped: one rigid body has all their vertices, or their bodies are out of scope.
  template <class A, class B>
  bool skips(const A& a, const B& b) const {
    if (!mesh_) return false;
    if (!mesh_->judged.of_vertices(*a.begin(), *b.begin())) return true;
    const int body = mesh_->common_rigid_body(a);
    return body >= 0 && body == mesh_->common_rigid_body(b);
  }
  /// How many of the primitives have a pair in scope.
  template <class Ids>
  long n_asked(const Ids& primitives) const {
    if (!mesh_ || mesh_->judged.scope == Scope::all) return primitives.cols();
    const auto columns = primitives.colwise();
    return std::count_if(columns.begin(), columns.end(),
                         [this](const auto& ids) { return mesh_->judged.asks(ids[0]); });
  }

 private:
  template <class Column>
  Box box_of(const Column& ids) const {
    Box b;
    for (const int v : ids) b.add(x0_->col(v)), b.add(x1_->col(v));
    if (mesh_->planar) b.lo[2] = b.hi[2] = 0.0;
    return b;
  }
  template <class Column>
  void add(const Column& ids) {
    const int body = mesh_->common_rigid_body(ids);
    if (body >= static_cast<int>(bodies_.size())) bodies_.resize(static_cast<std::size_t>(body) + 1);
    (body < 0 ? others_ : bodies_[static_cast<std::size_t>(body)]).add(box_of(ids));
  }

  const AuditMesh* mesh_ = nullptr;
  const Positions *x0_ = nullptr, *x1_ = nullptr;
  std::vector<Box> bodies_;  // of the primitives of each rigid body
  Box others_;               // of all other primitives
};

}  // namespace bb::audit
