// The contact table: one row a pair, columns of numbers. Geometry fills d and the weights, the stiffness
// policy fills kappa, the shape fills b, b', b''; everything after is common code and knows no formulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/barrier/stiffness_policy.hpp"
#include "core/contact/contact_key.hpp"
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
/// Kind of a row whose edges are close to parallel, or whose edge is to the axis of a cylinder, after those of
/// ContactKind: barrier times mollifier.
constexpr std::uint8_t mollified_kind = 7;
BB_HD constexpr bool is_obstacle(ContactKind kind) { return kind >= ContactKind::obstacle; }

/// Of the row of a pair. stencil, weight: number k at [by * k].
inline ContactKey key_of(PairId pair, const int* stencil, const double* weight, std::size_t by = 1) {
  std::array<int, 4> own;
  for (std::size_t k = 0; k < 4; ++k) {
    // the weight of an obstacle that moves is -1, those of its pair are between 0 and 1
    const bool stands = pair_obstacle(pair) >= 0 && weight[by * k] < -0.5;
    own[k] = stands ? -1 : stencil[by * k];
  }
  return row_key(pair, own);
}

/// One row a candidate pair that is closer than its activation distance (row_rule.hpp), in the order of the pairs; what
/// contact weights and models add and leave out is described there (pair_corrections.hpp, offset_blocks.hpp).
struct ContactTable {
  std::vector<ContactKind> kind;
  std::vector<PairId> pair;  // [n] ascending
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
  std::vector<KappaParts> parts;  // [n] kappa as a function of d
  /// [n] by which kappa of the policy is multiplied: where pairs are weighted by area m^2, below 0 in corrections; empty
  /// where all pairs count as one.
  std::vector<double> share;
  std::vector<double> kappa;  // [n] N/m, parts at d
  /// [n] N/m: what kappa the row came with when its iterate was accepted; 0: it was not there before. Empty
  /// of meaning in rows that no stiffness was given to.
  std::vector<double> kappa_before;
  /// [n] m^2, m, 1. kappa times these are energy, force and stiffness, kappa'(d) included where the policy has a
  /// potential.
  std::vector<double> b, db, d2b;
  // obstacle rows only, else 0; of vertices grad^2 d = curvature (I - n n^T - flat flat^T)
  std::vector<double> curvature;  // [n] 1/m
  std::vector<double> flat;       // [3 n] axis of a cylinder, else 0

  /// kappa b' (N) and kappa b'' (N/m): what columns in an executor's memory are called (executor_rows.hpp).
  double force(std::size_t r) const { return kappa[r] * db[r]; }
  double stiffness(std::size_t r) const { return kappa[r] * d2b[r]; }
  std::size_t size() const { return d.size(); }
  ContactKey key(std::size_t r) const { return key_of(pair[r], &stencil[4 * r], &stencil_weight[4 * r]); }
  void resize(std::size_t n);
};

/// Edge-edge rows close to parallel, and those of an edge and a cylinder's axis: B gains the mollifier e(x); e b(d),
/// full gradient, PSD-projected Hessian. In the order of the pairs, of which a ContactTable has none at the same state.
struct MollifiedTable {
  /// [4 n] ea0 ea1 eb0 eb1; of an edge and an axis e0 e1, that of an obstacle that moves or -1, -1
  std::vector<int> stencil;
  std::vector<double> stencil_weight;    // [4 n] w_i in the same order, 0 padded
  std::vector<int> vertex;               // [4 n] = stencil, -1 where the vertex is prescribed
  std::vector<double> eps;               // [n] threshold on |ea x eb|^2, m^4; on |e x axis|^2, m^2
  std::vector<double> axis, axis_point;  // [3 n] unit, and a point of it, m; 0 in rows of two edges
  std::vector<PairId> pair;              // [n] ascending
  std::vector<KappaParts> parts;
  std::vector<double> d, d_hat, offset, share, kappa, kappa_before, b, db, d2b;  // as above
  // what a policy reads of a row: compact free columns, as in ContactTable
  std::vector<int> free_vertex;  // [4 n]
  std::vector<double> weight;    // [4 n]
  std::vector<int> n_free;       // [n]
  std::vector<double> normal;    // [3 n]

  ContactKey key(std::size_t r) const { return key_of(pair[r], &stencil[4 * r], &stencil_weight[4 * r]); }
  double force(std::size_t r) const { return kappa[r] * db[r]; }  // of b alone
  double stiffness(std::size_t r) const { return kappa[r] * d2b[r]; }
  bool of_axis(std::size_t r) const {
    return axis[3 * r] != 0 || axis[3 * r + 1] != 0 || axis[3 * r + 2] != 0;
  }
  std::size_t size() const { return d.size(); }
  void resize(std::size_t n);
};

}  // namespace bb
