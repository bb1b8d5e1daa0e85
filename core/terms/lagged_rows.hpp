// Energies of the relative motion of the closest points of contacts (docs/design.md, Friction, Restitution), as families of rows: a row
// keeps what its contact was in the state that it was taken from. Number k of a row is column[k n + row].
#pragma once

#include "core/energy/friction.hpp"
#include "core/energy/restitution.hpp"
#include "core/exec/kernel.hpp"

namespace bb {

/// Rows in the memory of an executor.
struct LaggedRows {
  exec::Index n;
  const int* vertex;       // [4, n] given ones too, -1 padded
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
  /// What of a motion [3 n_vertices] (m, 0 at free vertices) is relative, m.
  BB_HD Vec3d moved(const double* motion, exec::Index r) const {
    return weighted<double>(
        r, [=](exec::Index v) { return Vec3d(motion[3 * v], motion[3 * v + 1], motion[3 * v + 2]); });
  }
};

/// Friction. Law: of core/energy/friction_laws.
template <class Law>
struct FrictionRows : LaggedRows {
  const double*
      spin;    // [3, n] m, what the turn of an obstacle takes its surface along by; null: nothing turns
  double eps;  // m

  template <class T = double>
  BB_HD LawWithEps<Law, T> law() const {
    return {static_cast<T>(eps)};
  }
  template <class T = double>
  BB_HD Vec<T, 3> slide(const double* x, exec::Index r) const {
    Vec<T, 3> way = motion<T>(x, r);
    if (spin) {
      way -= Vec<T, 3>(static_cast<T>(spin[r]), static_cast<T>(spin[n + r]), static_cast<T>(spin[2 * n + r]));
    }
    return slide_of<T>(way, normal_of<T>(r));
  }
  template <class T = double>
  BB_HD T value(const double* x, exec::Index r) const {
    return friction_value<T>(slide<T>(x, r), static_cast<T>(strength[r]), law<T>());
  }
  template <class T = double>
  BB_HD MotionTerms<T> terms(const double* x, exec::Index r) const {
    return friction_of_slide<T>(slide<T>(x, r), normal_of<T>(r), static_cast<T>(strength[r]), law<T>());
  }
};

/// Restitution.
struct RestitutionRows : LaggedRows {
  double dt;  // s

  template <class T = double>
  BB_HD ContactDamping<T> damping(exec::Index r) const {
    return {static_cast<T>(strength[r] / dt), static_cast<T>(load[r])};
  }
  template <class T = double>
  BB_HD T value(const double* x, exec::Index r) const {
    return damping_value<T>(motion<T>(x, r), normal_of<T>(r), damping<T>(r));
  }
  template <class T = double>
  BB_HD MotionTerms<T> terms(const double* x, exec::Index r) const {
    return damping_terms<T>(motion<T>(x, r), normal_of<T>(r), damping<T>(r));
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

/// How the forces change, to first order, along a motion of given vertices.
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
