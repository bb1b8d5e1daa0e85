// Rows of friction (docs/theory/friction.md): the energy of a slide, and what turns of obstacles add to it. A law is core/energy/friction_laws'.
#pragma once

#include "core/contact/obstacle_arm.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/terms/lagged_rows.hpp"

namespace bb {

/// Law: of core/energy/friction_laws.
template <class Law>
struct FrictionRows : LaggedRows {
  const double*
      spin;  // [3, n] m, what the turn of an obstacle takes its surface along by; null: nothing turns
  const double* kinetic;  // [n] coefficient over the static one, which strength has; null: 1 of all
  double eps, reach;      // m, of SlideScales
  double secant = 0;      // of LawInTerm, in the matrix

  template <class T = double>
  BB_HD LawInTerm<Law, T> law(exec::Index r) const {
    return {{static_cast<T>(eps), kinetic ? static_cast<T>(kinetic[r]) : T(1), static_cast<T>(reach)},
            static_cast<T>(secant)};
  }
  template <class T = double>
  BB_HD Vec<T, 3> way(const double* x, exec::Index r) const {
    Vec<T, 3> out = motion<T>(x, r);
    if (spin) {
      out -= Vec<T, 3>(static_cast<T>(spin[r]), static_cast<T>(spin[n + r]), static_cast<T>(spin[2 * n + r]));
    }
    return out;
  }
  template <class T = double>
  BB_HD Vec<T, 3> slide(const double* x, exec::Index r) const {
    return slide_of<T>(way<T>(x, r), normal_of<T>(r));
  }
  template <class T = double>
  BB_HD T value(const double* x, exec::Index r) const {
    return friction_value<T>(slide<T>(x, r), static_cast<T>(strength[r]), law<T>(r));
  }
  template <class T = double>
  BB_HD MotionTerms<T> terms(const double* x, exec::Index r) const {
    return friction_of_slide<T>(slide<T>(x, r), normal_of<T>(r), static_cast<T>(strength[r]), law<T>(r));
  }
};

/// How far an obstacle has turned, column-major: where the rows are of, and at both ends of the step.
struct ObstacleTurn {
  ObstacleKind kind;
  double axis[3], radius;  // m
  double lagged[9], begin[9], end[9];
  bool turns;
};

/// spin [3, n]: what the turn of its obstacle takes the surface of a row along by in the step, m.
struct FindSpins {
  LaggedRows rows;
  const PairId* pair;
  const ObstacleTurn* turn;
  const double* lagged;  // [3 n_vertices] m, the state that the rows are of
  double* spin;
  BB_HD void operator()(exec::Index r) const {
    Vec3d out = Vec3d::Zero();
    const int o = pair_obstacle(pair[r]);
    if (o >= 0 && turn[o].turns) {
      const ObstacleTurn& of = turn[o];
      const AnalyticSurface<double> surface{of.kind, Vec3d::Zero(), Vec3d(of.axis[0], of.axis[1], of.axis[2]),
                                            of.radius, false};
      // From the point of the obstacle, which is a vertex that moves, to the other side of the contact.
      const Vec3d arm = rows.moved(lagged, r);
      out = way_of_turn<double>(arm_to_surface<double>(surface, arm), matrix(of.lagged), matrix(of.begin),
                                matrix(of.end));
    }
    for (int c = 0; c < 3; ++c) spin[c * rows.n + r] = out[c];
  }

 private:
  BB_HD static Mat3d matrix(const double* numbers) {
    Mat3d out;
    for (int c = 0; c < 9; ++c) out.data()[c] = numbers[c];
    return out;
  }
};

/// kinetic [n]: the coefficient of each row over its static one, 1 where that is 0.
struct KineticParts {
  LaggedRows rows;
  SideCoefficients at_rest, sliding;
  const PairId* pair;
  double* kinetic;
  BB_HD void operator()(exec::Index r) const {
    const double most = at_rest.of(rows.vertex + r, rows.n, pair[r]);
    kinetic[r] = most > 0 ? sliding.of(rows.vertex + r, rows.n, pair[r]) / most : 1;
  }
};

/// What a step reports of friction.
struct FrictionNumbers {
  exec::Compensated work;  // J
  exec::Key sticking, sliding;
  BB_HD static FrictionNumbers zero() { return {exec::Compensated::zero(), 0, 0}; }
  friend BB_HD FrictionNumbers operator+(const FrictionNumbers& a, const FrictionNumbers& b) {
    return {a.work + b.work, a.sticking + b.sticking, a.sliding + b.sliding};
  }
};
/// Parts of SumParts.
template <class Law>
struct FrictionOfRows {
  using Sum = FrictionNumbers;
  FrictionRows<Law> rows;
  const double* x;
  BB_HD void operator()(exec::Index r, FrictionNumbers& sum) const {
    if (!(rows.strength[r] > 0)) return;
    const double y = rows.slide(x, r).norm();
    sum.work.add(friction_work<double>(y, rows.strength[r], rows.law(r)));
    (y < rows.eps ? sum.sticking : sum.sliding) += 1;
  }
};

}  // namespace bb
