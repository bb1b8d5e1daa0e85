// The collision primitives of a scene: which there are, which can move, which never pair, and the contact
// distances of each. Fixed for a whole run.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/pair.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// Contact distances of one primitive: means over its vertices, m.
struct Side {
  double d_hat, offset;
};

/// The largest level at which a collision-free step may stop (/contact/min_gap_fraction), in units of d_hat.
inline constexpr double largest_min_gap_fraction = 0.1;

/// A pair of one body that rests closer than this many d_hat has a d_hat of its own: its gap at rest over the same number.
inline constexpr double rest_rule_factor = 1.5;

/// Gap law of a pair: mean activation distance and summed offset of its two sides, m.
BB_HD inline Side combine(const Side& a, const Side& b) {
  return {a.d_hat + (b.d_hat - a.d_hat) / 2, a.offset + b.offset};
}

/// Primitives of one kind with N vertices each.
template <int N>
struct Primitives {
  std::vector<std::array<int, N>> vertices;  // global ids; edges ascending
  std::vector<Side> side;
  std::vector<std::uint8_t> free;  // 1 when at least one vertex is free
  std::vector<std::uint8_t> lone;  // 1 when it is no vertex or side of a larger primitive of the surface
  std::size_t size() const { return vertices.size(); }
};

/// A pair is named by the indices of its two primitives in 30 bits each (PairId).
constexpr std::size_t most_primitives = (std::size_t{1} << 30) - 1;

/// Errors: std::length_error, which names the kind, where a surface has more of a kind than pairs can name.
void check_primitive_count(const char* kind, std::size_t n, std::size_t most = most_primitives);

/// Whether pairs of one body that are close at rest have a smaller d_hat.
enum class RestRule { on, off };

/// Errors: std::length_error as above.
struct Surface {
  explicit Surface(const Scene& scene, RestRule rest_rule = RestRule::on);

  std::vector<std::uint8_t> vertex_free;  // [n_vertices]
  std::vector<int> body;                  // [n_vertices]
  int n_bodies;
  Collisions collisions;
  Positions rest;  // [3 x n_vertices] m
  Primitives<1> points;
  Primitives<2> edges;
  Primitives<3> triangles;
  std::vector<std::array<int, 3>>
      filled;                   // triangles with a free vertex, planar scenes' too: what nothing may pierce
  std::vector<int> lone_edges;  // of `edges`, in space: those that are no side of a triangle, ascending
  bool planar;
  PlanarPairs planar_pairs;
  RestRule rest_rule;
  double element_size = 0;  // m: 16 median edges at rest and contact reaches

  bool is_free(int v) const { return vertex_free[static_cast<std::size_t>(v)] != 0; }
  /// Whether the rest shape says something of two vertices: they are of one body, and the rest rule is on.
  bool ruled_at_rest(int v, int w) const {
    return rest_rule == RestRule::on &&
           body[static_cast<std::size_t>(v)] == body[static_cast<std::size_t>(w)];
  }
  /// What the bodies of two vertices do, and of a vertex and an obstacle by its number.
  CollisionKind kind_of(int v, int w) const {
    return collisions.kind(body[static_cast<std::size_t>(v)], body[static_cast<std::size_t>(w)]);
  }
  CollisionKind kind_at_obstacle(int v, int obstacle) const {
    return collisions.kind(body[static_cast<std::size_t>(v)], n_bodies + obstacle);
  }
  /// Of N vertices, m.
  template <int N>
  Mat<double, 3, N> rest_points(const int* vertex) const {
    Mat<double, 3, N> out;
    for (int k = 0; k < N; ++k) out.col(k) = rest.col(vertex[k]);
    return out;
  }

  /// Planar: true when no pair of these may exist. Two vertices: one mesh edge joins them. A vertex (second
  /// argument list) and an edge: the edge's own, or the third vertex of a triangle that has the edge.
  bool connected(int vertex, int other) const;
  bool adjacent(int vertex, const std::array<int, 2>& edge) const;
  /// No common vertex; all that pairs in space require.
  static bool disjoint(int vertex, const std::array<int, 2>& edge) {
    return (vertex != edge[0]) & (vertex != edge[1]);
  }
  static bool disjoint(int vertex, const std::array<int, 3>& triangle) {
    return (vertex != triangle[0]) & (vertex != triangle[1]) & (vertex != triangle[2]);
  }
  static bool disjoint(const std::array<int, 2>& a, const std::array<int, 2>& b) {
    return (a[0] != b[0]) & (a[0] != b[1]) & (a[1] != b[0]) & (a[1] != b[1]);
  }

  /// What connected and adjacent look up, each sorted: mesh edges (vertex_vertex) and (e0, e1, third vertex)
  /// (point_edge).
  const std::vector<std::array<int, 2>>& connected_pairs() const { return connected_; }
  const std::vector<std::array<int, 3>>& opposite_corners() const { return opposite_; }

 private:
  void connect(const Scene& scene);
  void find_filled(const Scene& scene);
  void find_lone();

  std::vector<std::array<int, 2>> connected_;  // sorted mesh edges (vertex_vertex)
  std::vector<std::array<int, 3>> opposite_;   // sorted (e0, e1, third vertex) (point_edge)
};

}  // namespace bb
