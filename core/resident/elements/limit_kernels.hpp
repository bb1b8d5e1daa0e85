// The strain limit: pseudo-gaps, barrier terms, stiffness, energies and step bound of limited triangles.
#pragma once

#include "barriers/shapes/gap_potential.hpp"
#include "barriers/stiffness/scaled_policy.hpp"
#include "core/barrier/barrier_row.hpp"
#include "core/barrier/relative_change.hpp"
#include "core/energy/strain_limit.hpp"
#include "core/energy/strain_stiffness.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/gather_kernels.hpp"
#include "core/resident/linear/sub_matrix.hpp"
#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

/// Columns of n limited triangles; those of two numbers an element are [2, n].
struct LimitColumns : ElementVertices<3> {
  RestColumns rest;
  const double *onset, *band_width;  // [n] 1
  double *sigma, *gap;   // [2, n] singular values, descending, and pseudo-gaps, at the measured state
  double *b, *db, *d2b;  // [2, n] barrier terms there, for kappa = 1; with kappa where it has a potential
  double* kappa;         // [n] J; 1 where it has a potential

  BB_HD StrainBand<double> band(Index e) const { return {onset[e], band_width[e]}; }
  BB_HD StrainShape<double> shape(Index e) const {
    return {Vec2d(b[e], b[n + e]), Vec2d(db[e], db[n + e]), Vec2d(d2b[e], d2b[n + e])};
  }
  BB_HD double smaller_gap(Index e) const { return gap[n + e] < gap[e] ? gap[n + e] : gap[e]; }
};

/// As a family of elements. x is the measured state. R: 3 in space, 2 in the x-y plane.
template <int R>
struct Limit : LimitColumns {
  BB_HD double value(const double*, Index e) const { return kappa[e] * (b[e] + b[n + e]); }
  BB_HD ElementTerms<double, 9> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[3];
    points(x, e, p);
    const TriangleRest<double> at_rest = rest.at(e, n);
    Svd<double, R, 2> svd{{}, Vec2d(sigma[e], sigma[n + e]), {}};  // an inactive element needs no factors
    if (gap[e] < band_width[e]) svd = signed_svd(deformation_gradient<R>(at_rest, p));
    return strain_limit_terms<R, double>(at_rest, svd, band(e), shape(e), kappa[e], projection);
  }
};
using SpaceLimit = Limit<3>;
using PlanarLimit = Limit<2>;

/// Singular values and pseudo-gaps of an element at x.
template <int R>
BB_HD void measure_stretch(const LimitColumns& limit, const double* x, Index e) {
  Vec3d p[3];
  limit.points(x, e, p);
  const Vec2d sigma = signed_svd(deformation_gradient<R>(limit.rest.at(e, limit.n), p)).sigma;
  for (int k = 0; k < 2; ++k) {
    limit.sigma[k * limit.n + e] = sigma[k];
    limit.gap[k * limit.n + e] = stretch_gap(sigma[k], limit.band(e));
  }
}
template <int R>
struct MeasureStretch {
  LimitColumns limit;
  const double* x;
  BB_HD void operator()(Index e) const { measure_stretch<R>(limit, x, e); }
};

/// Barrier terms at the measured pseudo-gaps, one an item of [2, n]; infinite at or beyond the limit.
template <class S>
struct LimitShape {
  LimitColumns limit;
  Argument argument;
  bool literal;
  const KappaParts* parts;  // [n] J, where kappa has a potential; else null
  BB_HD void operator()(Index i) const {
    const Index e = i < limit.n ? i : i - limit.n;
    const double gap = limit.gap[i], width = limit.band_width[e];
    const bool inside = literal || gap > 0;
    ShapeTerms<double> terms = barrier_row<S, double>(argument, literal, inside ? gap : width, width);
    if constexpr (shapes::HasPotential<S>) {
      if (parts) {
        const auto psi = shapes::potential_terms<S>(inside ? gap : width, width);
        terms = folded_row<double>(terms, psi, parts[e], width);
      }
    }
    constexpr double infinity = std::numeric_limits<double>::infinity();
    limit.b[i] = inside ? terms.b : infinity;
    limit.db[i] = inside ? terms.db : -infinity;
    limit.d2b[i] = inside ? terms.d2b : infinity;
  }
};

/// Both, and energies and the first element at or beyond its limit, or without a number: of a state whose kappa is known.
template <int R, class S>
struct MeasureLimit {
  LimitShape<S> shape;
  const double* x;
  double* energy;  // [n] J
  Key* beyond;
  BB_HD void operator()(Index e) const {
    const LimitColumns& limit = shape.limit;
    measure_stretch<R>(limit, x, e);
    shape(e);
    shape(limit.n + e);
    energy[e] = limit.kappa[e] * (limit.b[e] + limit.b[limit.n + e]);
    if (!(limit.smaller_gap(e) > 0)) exec::atomic_min(beyond, static_cast<Key>(e));
  }
};

/// kappa_e at the measured pseudo-gaps by a policy of strain limits, P a struct of barriers/stiffness.
template <class P>
struct ElementKappa {
  LimitColumns limit;
  ScaledPolicy<P> policy;
  bool with_hessian;
  StiffnessTime time;
  const double* x_n;           // [3 n_vertices] m, start of the step
  const double* vertex_mass;   // [n_vertices] kg
  const double* element_mass;  // [n] kg; null where the policy is uniform
  MatrixPart elastic;          // read where the policy needs it
  KappaParts* parts;           // [n] J, written where kappa has a potential; else null
  double* before;              // [n] J, kappa before this refresh; null where the policy is uniform
  BB_HD void operator()(Index e) const {
    const ElementSums<double> sums = sums_of(e);
    if (before) before[e] = limit.kappa[e];
    if (parts) {
      parts[e] = policy.element_parts(sums, limit.band_width[e], time);
      limit.kappa[e] = 1;
      return;
    }
    limit.kappa[e] = policy.element_kappa(sums, limit.smaller_gap(e), limit.band_width[e], time);
  }

 private:
  /// A policy of one stiffness reads the area alone.
  BB_HD ElementSums<double> sums_of(Index e) const {
    if constexpr (requires { policy.values.uniform_kappa(); }) {
      ElementSums<double> out;
      out.measure = limit.rest.area[e];
      return out;
    } else {
      Vec3d p[3], mass;
      limit.points(x_n, e, p);
      for (int k = 0; k < 3; ++k) mass[k] = vertex_mass[limit.vertex(k, e)];
      return element_sums<double>(
          p, mass, element_mass ? element_mass[e] : 0.0, limit.rest.area[e], [&] { return elastic_block(e); },
          with_hessian);
    }
  }
  BB_HD Mat<double, 9, 9> elastic_block(Index e) const {
    const int vertices[3] = {limit.vertex(0, e), limit.vertex(1, e), limit.vertex(2, e)};
    const SubMatrix h(elastic, vertices, 3);
    Mat<double, 9, 9> out;
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 9; ++i) out(i, j) = h(i, j);
    }
    return out;
  }
};

/// Least of the elements' step bounds below `alpha`, as ordered bits. R as in Limit.
template <int R>
struct StretchBound {
  LimitColumns limit;
  const double *x, *dx;
  double alpha, park;
  const Key* before;  // the bits of alpha instead, all ones where this is no bound; or null
  Key* smallest;
  BB_HD void operator()(Index e) const {
    if (before && *before == ~Key{0}) return;
    const double most = before ? exec::from_ordered_bits(*before) : alpha;
    Vec3d p[3], step[3];
    limit.points(x, e, p);
    limit.points(dx, e, step);
    const double bound =
        strain_step_bound<R, double>(limit.rest.at(e, limit.n), p, step, limit.band(e), most, park);
    if (bound < most) exec::atomic_min(smallest, exec::ordered_bits(bound));
  }
};

// --- keys (sum_kernels.hpp)
/// Largest change of the kappa of active elements.
struct LimitKappaChange {
  LimitColumns limit;
  const double* before;
  BB_HD Key operator()(Index e) const {
    const bool active = limit.smaller_gap(e) < limit.band_width[e];
    return largest_key(active ? relative_change(before[e], limit.kappa[e]) : 0.0);
  }
};
/// What is said of a state: complements of keys (sum_kernels.hpp) of the largest singular value, of the largest force of
/// an active element over its rest area, N/m, and of the smallest pseudo-gap in units of the width.
struct LimitNumbers {
  Key stretch, load, gap;
  BB_HD static LimitNumbers zero() { return {0, 0, 0}; }
  friend BB_HD LimitNumbers operator+(const LimitNumbers& a, const LimitNumbers& b) {
    LimitNumbers out = a;
    raise_key(out.stretch, b.stretch), raise_key(out.load, b.load), raise_key(out.gap, b.gap);
    return out;
  }
};
struct LimitParts {
  using Sum = LimitNumbers;
  LimitColumns limit;
  BB_HD double load(Index i, Index e) const {
    using std::abs;
    const bool active = limit.gap[i] < limit.band_width[e];
    return active ? abs(limit.kappa[e] * limit.db[i]) / limit.rest.area[e] : 0.0;
  }
  BB_HD void operator()(Index e, LimitNumbers& sum) const {
    raise_key(sum.stretch, ~largest_key(limit.sigma[e]));
    raise_key(sum.load, ~largest_key(load(e, e)));
    raise_key(sum.load, ~largest_key(load(limit.n + e, e)));
    raise_key(sum.gap, ~smallest_key(limit.smaller_gap(e) / limit.band_width[e]));
  }
};

}  // namespace bb::resident
