// The contact table: one row a contact, columns of numbers. Geometry fills d and the weights, the stiffness
// policy fills kappa, the shape fills b, b', b''; everything after is common code and knows no formulation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/barrier/stiffness_policy.hpp"
#include "core/math/types.hpp"

namespace bb {

/// The last three: an analytic obstacle against a vertex, the inside of an edge, the inside of a triangle.
enum class ContactKind : std::uint8_t {
  point_point,
  point_edge,
  point_triangle,
  edge_edge,
  obstacle,
  obstacle_edge,
  obstacle_triangle
};
constexpr bool is_obstacle(ContactKind kind) { return kind >= ContactKind::obstacle; }

/// Identity of a contact across iterations: sorted ids of all its vertices, given ones included, -1 padded in
/// front; an obstacle o appears as -2 - o.
using ContactKey = std::array<int, 4>;
constexpr int id_of_obstacle(int obstacle) { return -2 - obstacle; }
/// The obstacle of an entry of a key; -1 where it is a vertex or padding.
constexpr int obstacle_of(int id) { return id < -1 ? -2 - id : -1; }

/// Identity of one candidate pair over a whole run, whatever features realise it; compare only.
using PairId = std::uint64_t;

/// Rows are sorted by (key, kind), so that two tables can be joined by a merge.
struct ContactTable {
  std::vector<ContactKind> kind;
  std::vector<ContactKey> key;
  /// [4 n] all vertices in role order (p t0 t1 t2, ea0 ea1 eb0 eb1; of an obstacle's row its one to three, then that of an
  /// obstacle that moves), -1 padded
  std::vector<int> stencil;
  std::vector<double> stencil_weight;  // [4 n] w_i in the same order
  std::vector<int> vertex;             // [4 n] free vertices only, compact, -1 padded
  std::vector<double> weight;          // [4 n] their w_i, 0 padded
  std::vector<int> n_free;             // [n] 1..4
  std::vector<double> normal;          // [3 n] unit, grad_i d = w_i n
  /// [n] m; d = |r| - offset. Rows of an obstacle with an edge or a triangle: r from its centre or axis, its radius in
  /// the offset.
  std::vector<double> d, d_hat, offset;
  std::vector<double> multiplicity;  // [n] number of pairs that realise the row
  std::vector<std::size_t>
      pair_begin;  // [n + 1] those pairs are pair[pair_begin[r]] to pair[pair_begin[r + 1] - 1]
  std::vector<PairId> pair;
  std::vector<KappaParts> parts;  // [n] kappa as a function of d, mean over the pairs
  std::vector<double> kappa;      // [n] N/m, parts at d
  /// [n] N/m: what kappa the row came with when its iterate was accepted; 0: it was not there before. Empty
  /// of meaning in rows that no stiffness was given to.
  std::vector<double> kappa_before;
  /// [n] m^2, m, 1. kappa times these are energy, force and curvature, kappa'(d) included where the policy has a
  /// potential.
  std::vector<double> b, db, d2b;
  // obstacle rows only, else 0; of vertices grad^2 d = curvature (I - n n^T - flat flat^T)
  std::vector<double> curvature;  // [n] 1/m
  std::vector<double> flat;       // [3 n] axis of a cylinder, else 0

  std::size_t size() const { return d.size(); }
  void resize(std::size_t n);
};

/// Edge-edge rows close to parallel, and those of an edge and a cylinder's axis: B gains the mollifier e(x); e b(d),
/// full gradient, PSD-projected Hessian.
struct MollifiedTable {
  std::vector<ContactKey> key;
  std::vector<int>
      stencil;  // [4 n] ea0 ea1 eb0 eb1; e0 e1, vertex of the obstacle or -1, -1 of an edge and an axis
  std::vector<double> stencil_weight;    // [4 n] w_i in the same order, 0 padded
  std::vector<int> vertex;               // [4 n] = stencil, -1 where the vertex is given
  std::vector<double> eps;               // [n] threshold on |ea x eb|^2, m^4; on |e x axis|^2, m^2
  std::vector<double> axis, axis_point;  // [3 n] unit, and a point of it, m; 0 in rows of two edges
  std::vector<PairId> pair;              // [n]
  std::vector<KappaParts> parts;
  std::vector<double> d, d_hat, offset, multiplicity, kappa, kappa_before, b, db, d2b;  // as above
  // what a policy reads of a row: compact free columns, as in ContactTable
  std::vector<int> free_vertex;  // [4 n]
  std::vector<double> weight;    // [4 n]
  std::vector<int> n_free;       // [n]
  std::vector<double> normal;    // [3 n]

  bool of_axis(std::size_t r) const {
    return axis[3 * r] != 0 || axis[3 * r + 1] != 0 || axis[3 * r + 2] != 0;
  }
  std::size_t size() const { return d.size(); }
  void resize(std::size_t n);
};

}  // namespace bb
