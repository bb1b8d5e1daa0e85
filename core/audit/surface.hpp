// What the audit judges: vertices, edges, triangles and analytic obstacles. Plain data, no solver types.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/audit/judged_pairs.hpp"
#include "core/math/types.hpp"

namespace bb::audit {

enum class ObstacleKind { plane, sphere, cylinder };

/// Half-space, ball or infinite cylinder. The numbers count as written: `axis` need not have length one.
struct AuditObstacle {
  ObstacleKind kind = ObstacleKind::plane;
  Vec3d point = Vec3d::Zero();  // on the plane; centre; on the cylinder's axis (m)
  Vec3d axis = Vec3d::UnitZ();  // plane: normal towards the allowed side; cylinder: direction; sphere: unused
  double radius = 0.0;          // m; plane: unused
  bool inside = false;          // sphere, cylinder: the surface must stay inside instead of outside
  int vertex = -1;  // prescribed, whose position is `point`: the obstacle moves with it; -1: it stands still

  /// The allowed set is convex: a surface is in it when its vertices are.
  bool allows_a_convex_set() const { return kind == ObstacleKind::plane || inside; }
  bool moves() const { return vertex >= 0; }
  /// Where it is in the state x [3 n_vertices], m.
  AuditObstacle in(const Positions& x) const {
    AuditObstacle out = *this;
    if (moves()) out.point = x.col(vertex);
    return out;
  }
};

/// The whole surface of the bodies, whatever pairs a contact model makes of it. Pairs that share a vertex are
/// exempt, and in planar scenes an edge and the third vertex of its own triangle: passing it inverts the
/// triangle, which is counted as that. No others are.
struct AuditMesh {
  Eigen::Matrix2Xi edges;  // every edge that collides: of the triangles, and of rods. Planar: boundary edges
  Eigen::Matrix3Xi triangles;  // 3D: surface triangles. Planar: elements, judged for inversion only
  std::vector<int> opposite;   // [n_edges] or empty, planar: third vertex of the edge's triangle, -1: a rod
  std::vector<int> points;     // vertices of no edge (3D: nor triangle): particles, planar interior vertices
  std::vector<std::uint8_t>
      fixed;  // [n_vertices] or empty: prescribed and never moving. Driven vertices are not fixed
  std::vector<std::uint8_t> prescribed;  // [n_vertices] or empty: prescribed, still or driven
  std::vector<int>
      motion;  // [n_vertices] or empty: prescribed vertices with one number >= 0 move as one rigid
               // body, -1: any other. Empty: fixed vertices are such a body
  std::vector<double> thickness;  // [n_vertices] or empty: half thickness, m; only surface_gap reads it
  std::vector<AuditObstacle> obstacles;
  JudgedPairs judged;
  bool only_points = false;  // vertices at obstacles alone are judged; the rest is counted
  bool planar = false;       // the scene lives in x and y; z is ignored

  /// The rigid body that a vertex moves with, -1: none.
  int rigid_body(int v) const {
    if (!motion.empty()) return motion[static_cast<std::size_t>(v)];
    return is_fixed(v) ? 0 : -1;
  }
  /// The rigid body that all vertices of a primitive move with, -1: none.
  template <class Ids>
  int common_rigid_body(const Ids& ids) const {
    const int first = rigid_body(*ids.begin());
    const bool all =
        std::all_of(ids.begin(), ids.end(), [this, first](int v) { return rigid_body(v) == first; });
    return all ? first : -1;
  }
  /// Whether vertices are all that is judged against an obstacle.
  bool asks_vertices(const AuditObstacle& o) const { return only_points || o.allows_a_convex_set(); }
  bool is_fixed(int v) const { return !fixed.empty() && fixed[static_cast<std::size_t>(v)] != 0; }
  bool is_prescribed(int v) const {
    return !prescribed.empty() && prescribed[static_cast<std::size_t>(v)] != 0;
  }
  /// True if no vertex of the pair has unknowns: what happens there is decided by the scene alone.
  template <class Ids>
  bool all_prescribed(const Ids& ids) const {
    return std::all_of(ids.begin(), ids.end(), [this](int v) { return is_prescribed(v); });
  }
};

/// What kind of test found something; the order is the order in which first offenders are named.
enum class PairKind {
  edge_triangle,
  edge_edge_2d,
  vertex_triangle,
  edge_edge,
  vertex_edge_2d,
  vertex_obstacle,
  edge_obstacle,
  triangle_obstacle,
  inverted
};

/// An offender by its indices: edge, triangle and obstacle numbers, vertex ids; obstacles come second;
/// `inverted`: the triangle twice. Not proven: the pair could not be certified free, and no passage was shown either.
struct PairName {
  PairKind kind = PairKind::edge_triangle;
  int first = -1, second = -1;
  bool proven = true;
  auto operator<=>(const PairName&) const = default;
};

}  // namespace bb::audit
