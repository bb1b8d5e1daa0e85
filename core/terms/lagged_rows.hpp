// Energies of the relative motion of the closest points of contacts (docs/theory/friction.md), as families of rows: a row
// keeps what its contact was in the state that it was taken from. Number k of a row is column[k n + row].
#pragma once

#include "core/contact/combine_rule.hpp"
#include "core/contact/pair_id.hpp"
#include "core/energy/friction.hpp"
#include "core/exec/kernel.hpp"

namespace bb {

/// Rows in the memory of an executor.
struct LaggedRows {
  exec::Index n;
  const int* vertex;       // [4, n] prescribed ones too, -1 padded
  const double* weight;    // [4, n]
  const double* normal;    // [3, n] unit
  const double* strength;  // [n] N times the unit of 1 over the coefficient
  const double* load;      // [n] N
  const double* x_n;       // [3 n_vertices] m, from where motions are counted

  template <class T = double>
  BB_HD Vec<T, 3> normal_of(exec::Index r) const {
    return {static_cast<T>(normal[r]), static_cast<T>(normal[n + r]), static_cast<T>(normal[2 * n + r])};
  }
  template <class T = double>
  BB_HD Vec<T, 4> weights(exec::Index r) const {
    Vec<T, 4> out;
    for (int k = 0; k < 4; ++k) out[k] = static_cast<T>(weight[k * n + r]);
    return out;
  }
  /// Sum of the weights times what at(vertex) says.
  template <class T, class At>
  BB_HD Vec<T, 3> weighted(exec::Index r, const At& at) const {
    Vec<T, 3> out = Vec<T, 3>::Zero();
    for (int k = 0; k < 4; ++k) {
      const exec::Index v = vertex[k * n + r];
      if (v >= 0) out += static_cast<T>(weight[k * n + r]) * at(v);
    }
    return out;
  }
  /// Since x_n, m.
  template <class T = double>
  BB_HD Vec<T, 3> motion(const double* x, exec::Index r) const {
    const double* const from = x_n;
    return weighted<T>(r, [=](exec::Index v) {
      return Vec<T, 3>(static_cast<T>(x[3 * v] - from[3 * v]), static_cast<T>(x[3 * v + 1] - from[3 * v + 1]),
                       static_cast<T>(x[3 * v + 2] - from[3 * v + 2]));
    });
  }
  /// The motion of which the energy is a function; kinds that know more of it have their own.
  template <class T = double>
  BB_HD Vec<T, 3> way(const double* x, exec::Index r) const {
    return motion<T>(x, r);
  }
  /// What of a motion [3 n_vertices] (m, 0 at free vertices) is relative, m.
  BB_HD Vec3d moved(const double* motion, exec::Index r) const {
    return weighted<double>(
        r, [=](exec::Index v) { return Vec3d(motion[3 * v], motion[3 * v + 1], motion[3 * v + 2]); });
  }
};

/// The coefficient of a contact from those of its two sides: the body of its first vertex, and its obstacle or the body of its last
/// vertex.
struct SideCoefficients {
  const double* of_body;      // [bodies] 1
  const double* of_obstacle;  // [obstacles]
  const int* body;            // [n_vertices]
  CombineRule rule;
  /// vertex[k stride]: vertex k of four, -1 padded.
  BB_HD double of(const int* vertex, exec::Index stride, PairId pair) const {
    const double first = of_body[body[vertex[0]]];
    const int obstacle = pair_obstacle(pair);
    if (obstacle >= 0) return combined(rule, first, of_obstacle[obstacle]);
    int last = vertex[0];
    for (int k = 1; k < 4; ++k) {
      const int v = vertex[k * stride];
      if (v >= 0) last = v;
    }
    return combined(rule, first, of_body[body[last]]);
  }
};

/// strength [n]: coefficient times load.
struct RowStrengths {
  LaggedRows rows;
  SideCoefficients sides;
  const PairId* pair;
  double* strength;
  BB_HD void operator()(exec::Index r) const {
    strength[r] = sides.of(rows.vertex + r, rows.n, pair[r]) * rows.load[r];
  }
};

// --- Rows: LaggedRows with value<T>(x, row), J, and terms<T>(x, row), MotionTerms. A card has double alone.
template <class Rows, class T = double>
struct MotionValues {
  static constexpr exec::Index grain = 64;
  Rows rows;
  const double* x;
  double* energy;  // [n] J
  BB_HD void operator()(exec::Index r) const { energy[r] = rows.template value<T>(x, r); }
};

template <class Rows>
struct MotionGradients {
  Rows rows;
  const double* x;
  double *energy, *force;  // [n] J, [3, n] N
  BB_HD void operator()(exec::Index r) const {
    const MotionTerms<double> terms = rows.terms(x, r);
    energy[r] = terms.energy;
    for (int c = 0; c < 3; ++c) force[c * rows.n + r] = terms.grad[c];
  }
};

template <class Rows>
struct MotionHessians {
  Rows rows;
  const double* x;
  double* hess;  // [6, n] N/m, the lower triangle column by column
  BB_HD void operator()(exec::Index r) const {
    const Mat3d h = rows.terms(x, r).hess;
    int at = 0;
    for (int c = 0; c < 3; ++c) {
      for (int k = c; k < 3; ++k) hess[at++ * rows.n + r] = h(k, c);
    }
  }
};

/// How the forces change, to first order, along a motion of prescribed vertices.
template <class Rows>
struct MotionChanges {
  Rows rows;
  const double *x, *motion;  // [3 n_vertices] m; motion 0 at free vertices
  double* force;             // [3, n] N
  BB_HD void operator()(exec::Index r) const {
    const Vec3d moved = rows.moved(motion, r);
    Vec3d out = Vec3d::Zero();
    if (moved != Vec3d::Zero()) {
      const Mat3d h = rows.terms(x, r).hess;
      out = h * moved;
    }
    for (int c = 0; c < 3; ++c) force[c * rows.n + r] = out[c];
  }
};

}  // namespace bb
