// Which vertices are inside which closed bodies, by exact signs, and how deep. A vertex that is outside a closed body
// in one state and inside it in a later one has passed through it, however both moved in between.
#pragma once

#include <utility>
#include <vector>

#include "core/audit/surface.hpp"

namespace bb::audit {

struct Enclosed {
  using Pair = std::pair<int, int>;  // body, vertex
  std::vector<Pair> inside;          // ascending
  std::vector<Pair> undecided;       // on the surface, or every ray meets an edge; ascending
  long asked = 0;                    // vertices of other bodies, over all closed bodies; boxes decide most

  bool undecides(const Pair& pair) const;
  /// Pairs that are undecided here and were not `before` stay where they were then.
  void settle(const Enclosed& before);
};

/// Of a and b those pairs that are inside in exactly one and undecided in neither.
std::vector<Enclosed::Pair> changed_sides(const Enclosed& a, const Enclosed& b);

/// The closed bodies of a mesh in space: every edge has an even number of the body's triangles.
class ClosedBodies {
 public:
  /// @param first_vertex [n_bodies] ascending, the first 0: a body has the vertices up to the next one
  /// @param vertices     those that are checked, ascending
  ClosedBodies(const AuditMesh& mesh, std::vector<int> first_vertex, std::vector<int> vertices);

  /// Numbers of the closed bodies, ascending.
  std::vector<int> bodies() const;

  /// The state x [3 n_vertices], m, finite. The parity of crossings of a ray from a vertex with the body's triangles,
  /// exact; a ray that only touches one is replaced by another. Deterministic. Cost: O(bodies x vertices) boxes, and
  /// a microsecond or so a vertex within one.
  Enclosed enclosed(const Positions& x) const;

  /// Distance (m, rounded) of the vertex of each pair from the closest triangle of its body.
  std::vector<double> depths(const std::vector<Enclosed::Pair>& pairs, const Positions& x) const;

 private:
  struct Body {
    int number;
    std::vector<int> triangles;
  };
  bool owns(int body, int vertex) const;

  const AuditMesh& mesh_;
  std::vector<int> first_vertex_, vertices_;
  std::vector<Body> closed_;
};

}  // namespace bb::audit
