// The strain limit: pseudo-gaps, barrier terms, stiffness, energies and step bound of limited triangles (N = 2 singular values)
// and tetrahedra (N = 3). A host may choose the scalar T of what is measured; a card has double alone.
#pragma once

#include <type_traits>

#include "core/barrier/barrier_row.hpp"
#include "core/barrier/relative_change.hpp"
#include "core/barrier/scaled_policy.hpp"
#include "core/barrier/shape_potential.hpp"
#include "core/energy/families/element_kernels.hpp"
#include "core/energy/families/limit_values.hpp"
#include "core/energy/families/rest_kernels.hpp"
#include "core/energy/membrane_lanes.hpp"
#include "core/energy/strain_limit.hpp"
#include "core/energy/strain_stiffness.hpp"
#include "core/linear/executor/sub_matrix.hpp"

namespace bb {

template <int N>
using LimitedRest = std::conditional_t<N == 2, TriangleRest<double>, TetrahedronRest<double>>;

/// Columns of n limited elements; those of a number a singular value are [N, n].
template <int N>
struct LimitColumns : ElementVertices<N + 1> {
  using ElementVertices<N + 1>::n;

  RestColumnsOf<LimitedRest<N>> rest;
  const double *onset, *band_width;  // [n] 1
  double *sigma, *gap;   // [N, n] singular values, descending in size, and pseudo-gaps, at the measured state
  double *b, *db, *d2b;  // [N, n] barrier terms there, for kappa = 1; with kappa where it has a potential
  double* kappa;         // [n] J; 1 where it has a potential

  template <class T = double>
  BB_HD StrainBand<T> band(exec::Index e) const {
    return {static_cast<T>(onset[e]), static_cast<T>(band_width[e])};
  }
  /// The N numbers of element e.
  template <class T>
  BB_HD Vec<T, N> of_element(const double* column, exec::Index e) const {
    Vec<T, N> out;
    for (int k = 0; k < N; ++k) out[k] = static_cast<T>(column[k * n + e]);
    return out;
  }
  template <class T>
  BB_HD StrainShape<T, N> shape(exec::Index e) const {
    return {of_element<T>(b, e), of_element<T>(db, e), of_element<T>(d2b, e)};
  }
  BB_HD double smallest_gap(exec::Index e) const {
    double least = gap[e];
    for (int k = 1; k < N; ++k) least = gap[k * n + e] < least ? gap[k * n + e] : least;
    return least;
  }
  BB_HD double energy(exec::Index e) const {
    double sum = b[e];
    for (int k = 1; k < N; ++k) sum += b[k * n + e];
    return kappa[e] * sum;
  }
};

/// As a family of elements. x is the measured state. R: 3 in space, 2 in the x-y plane.
template <int R, int N>
struct Limit : LimitColumns<N> {
  template <class T = double>
  BB_HD double value(const double*, exec::Index e) const {
    return this->energy(e);
  }
  /// Where terms<T>() are 0 without factors.
  template <class T>
  bool is_slack(exec::Index e) const {
    if (this->gap[e] < this->band_width[e]) return false;  // its factors in T say whether it acts
    const StrainBand<T> band = this->template band<T>(e);
    return !(strain_gap(static_cast<T>(this->sigma[e]), band) < band.width);
  }
  template <class T = double>
  BB_HD ElementTerms<T, 3 * (N + 1)> terms(const double* x, exec::Index e, Projection projection) const {
    Vec<T, 3> p[N + 1];
    this->points(x, e, p);
    const auto at_rest = this->rest.template at<T>(e, this->n);
    // an inactive element needs no factors
    Svd<T, R, N> svd{{}, this->template of_element<T>(this->sigma, e), {}};
    if (this->gap[e] < this->band_width[e]) svd = signed_svd(deformation_gradient<R>(at_rest, p));
    return strain_limit_terms<R, T>(at_rest, svd, this->template band<T>(e), this->template shape<T>(e),
                                    static_cast<T>(this->kappa[e]), projection);
  }
};
using SpaceLimit = Limit<3, 2>;
using PlanarLimit = Limit<2, 2>;
using SolidLimit = Limit<3, 3>;

/// Singular values and pseudo-gaps of an element at x.
template <int R, class T, int N>
BB_HD void measure_stretch(const LimitColumns<N>& limit, const double* x, exec::Index e) {
  Vec<T, 3> p[N + 1];
  limit.points(x, e, p);
  const Svd<T, R, N> svd = signed_svd(deformation_gradient<R>(limit.rest.template at<T>(e, limit.n), p));
  for (int k = 0; k < N; ++k) {
    limit.sigma[k * limit.n + e] = svd.sigma[k];
    limit.gap[k * limit.n + e] = stretch_gap(svd.sigma[k], limit.template band<T>(e));
  }
}
/// How many elements are decomposed abreast on a host.
template <int R, int N>
constexpr int stretch_lanes = R == 3 && N == 2 ? membrane_lanes : 1;

/// measure_stretch() of the elements first to first + membrane_lanes - 1, with its bits. Host only.
template <class T>
void measure_stretches(const LimitColumns<2>& limit, const double* x, exec::Index first) {
  TrianglesAbreast<T> triangles;
  for (int lane = 0; lane < membrane_lanes; ++lane) {
    Vec<T, 3> p[3];
    limit.points(x, first + lane, p);
    triangles.set(lane, p, limit.rest.template at<T>(first + lane, limit.n));
  }
  T sigma[2][membrane_lanes];
  stretches_abreast(triangles, sigma);
  for (int lane = 0; lane < membrane_lanes; ++lane) {
    for (int k = 0; k < 2; ++k) {
      const exec::Index e = first + lane, i = k * limit.n + e;
      limit.sigma[i] = sigma[k][lane];
      limit.gap[i] = stretch_gap(sigma[k][lane], limit.template band<T>(e));
    }
  }
}

template <int R, int N, class T = double>
struct MeasureStretch {
  static constexpr exec::Index grain = elements_of_a_thread;
  LimitColumns<N> limit;
  const double* x;
  BB_HD void operator()(exec::Index e) const { measure_stretch<R, T>(limit, x, e); }
  static constexpr int lanes = stretch_lanes<R, N>;
  void abreast(exec::Index first) const requires(lanes > 1) { measure_stretches<T>(limit, x, first); }
};

/// Barrier terms of an element at its measured pseudo-gaps; infinite at or beyond the limit.
template <int N, class S>
struct LimitShape {
  static constexpr exec::Index grain = elements_of_a_thread;
  LimitColumns<N> limit;
  Argument argument;
  bool literal;
  const KappaParts* parts;  // [n] J, where kappa has a potential; else null
  BB_HD void operator()(exec::Index e) const {
#ifdef __CUDACC__
#pragma unroll 1  // the code of the shape once, and not once a singular value
#endif
    for (int k = 0; k < N; ++k) row(k * limit.n + e, e);
  }
  static constexpr int lanes = HasTerms<S> ? rows_abreast : 1;
  void abreast(exec::Index first) const requires(lanes > 1) {
    for (int k = 0; k < N; ++k) rows(k * limit.n + first, first);
  }

 private:
  /// Item i of [N, n], of element e.
  BB_HD void row(exec::Index i, exec::Index e) const {
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
  /// Items i to i + lanes - 1, of elements e to e + lanes - 1.
  void rows(exec::Index i, exec::Index e) const requires(lanes > 1) {
    const double *gap = limit.gap + i, *width = limit.band_width + e;
    bool plain = !literal && !parts, slack = true;
    for (int lane = 0; lane < lanes; ++lane) {
      plain = plain && gap[lane] > 0;
      slack = slack && gap[lane] >= width[lane];
    }
    if (plain && !slack) {
      barrier_rows<S>(argument, gap, width, limit.b + i, limit.db + i, limit.d2b + i);
      return;
    }
    for (int lane = 0; lane < lanes; ++lane)
      row(i + lane, e + lane);  // which costs nothing where all are slack
  }
};

/// Where kappa is known: the state x is measured, with its energies.
struct MeasureAt {
  const double* x;
  double* energy;
  exec::Key* beyond;
};

/// Energies, and the first element at or beyond its limit, or without a number.
template <int N>
BB_HD void finish_measure(const LimitColumns<N>& limit, const MeasureAt& at, exec::Index e) {
  at.energy[e] = limit.energy(e);
  if (!(limit.smallest_gap(e) > 0)) exec::atomic_min(at.beyond, static_cast<exec::Key>(e));
}

/// Pseudo-gaps, barrier terms and energies of a state whose kappa is known.
template <int R, int N, class S>
struct MeasureLimit {
  static constexpr exec::Index grain = elements_of_a_thread;
  LimitShape<N, S> shape;
  MeasureAt at;
  BB_HD void operator()(exec::Index e) const {
    measure_stretch<R, double>(shape.limit, at.x, e);
    shape(e);
    finish_measure(shape.limit, at, e);
  }
  static constexpr int lanes = LimitShape<N, S>::lanes;
  void abreast(exec::Index first) const requires(lanes > 1) {
    constexpr int step = stretch_lanes<R, N>;
    static_assert(lanes % step == 0);
    for (int lane = 0; lane < lanes; lane += step) {
      if constexpr (step > 1) {
        measure_stretches<double>(shape.limit, at.x, first + lane);
      } else {
        measure_stretch<R, double>(shape.limit, at.x, first + lane);
      }
    }
    shape.abreast(first);
    for (int lane = 0; lane < lanes; ++lane) finish_measure(shape.limit, at, first + lane);
  }
};

template <int N>
struct ElementKappaInputs {
  LimitColumns<N> limit;
  bool with_hessian;
  KappaSources from;
  const double* element_mass;  // [n] kg; null where the policy is uniform
  KappaParts* parts;           // [n] J, written where kappa has a potential; else null
  double* before;              // [n] J, kappa before this refresh; null where the policy is uniform
};

/// kappa_e at the measured pseudo-gaps by a policy of strain limits, P its struct of values.
template <int N, class P>
struct ElementKappa {
  static constexpr exec::Index grain = elements_of_a_thread;
  ElementKappaInputs<N> of;
  ScaledPolicy<P> policy;
  BB_HD void operator()(exec::Index e) const {
    const LimitColumns<N>& limit = of.limit;
    const ElementSums<double> sums = sums_of(e);
    if (of.before) of.before[e] = limit.kappa[e];
    if (of.parts) {
      of.parts[e] = policy.element_parts(sums, limit.band_width[e], of.from.time);
      limit.kappa[e] = 1;
      return;
    }
    limit.kappa[e] = policy.element_kappa(sums, limit.smallest_gap(e), limit.band_width[e], of.from.time);
  }

 private:
  static constexpr int size = 3 * (N + 1);
  using Block = Mat<double, size, size>;

  /// A policy of one stiffness reads the area or volume alone.
  BB_HD ElementSums<double> sums_of(exec::Index e) const {
    const LimitColumns<N>& limit = of.limit;
    if constexpr (requires { policy.values.uniform_kappa(); }) {
      ElementSums<double> out;
      out.measure = limit.rest.measure[e];
      return out;
    } else {
      Vec3d p[N + 1];
      Vec<double, N + 1> mass;
      limit.points(of.from.x_n, e, p);
      for (int k = 0; k <= N; ++k) mass[k] = of.from.vertex_mass[limit.vertex(k, e)];
      return element_sums<double>(
          p, mass, of.element_mass ? of.element_mass[e] : 0.0, limit.rest.measure[e],
          [&] { return elastic_block(e); }, of.with_hessian);
    }
  }
  BB_HD Block elastic_block(exec::Index e) const {
    Block out;
    if (of.from.elastic.gathered) {
      const double* block = of.from.elastic.gathered + size * size * e;
      for (int i = 0; i < size * size; ++i) out.data()[i] = block[i];
      return out;
    }
    int vertices[N + 1];
    for (int k = 0; k <= N; ++k) vertices[k] = of.limit.vertex(k, e);
    const exec::SubMatrix h(of.from.elastic.part, vertices, N + 1);
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < size; ++i) out(i, j) = h(i, j);
    }
    return out;
  }
};

/// Least of the elements' step bounds below `alpha`, as ordered bits. R as in Limit.
template <int R, int N, class T = double>
struct StretchBound {
  static constexpr exec::Index grain = elements_of_a_thread;
  LimitColumns<N> limit;
  const double *x, *dx;
  double alpha, park;
  const exec::Key* before;  // the bits of alpha instead, all ones where this is no bound; or null
  exec::Key* smallest;
  BB_HD void operator()(exec::Index e) const {
    if (before && *before == ~exec::Key{0}) return;
    const T most = static_cast<T>(before ? exec::from_ordered_bits(*before) : alpha);
    Vec<T, 3> p[N + 1], step[N + 1];
    limit.points(x, e, p);
    limit.points(dx, e, step);
    const T bound = strain_step_bound<R, T>(limit.rest.template at<T>(e, limit.n), p, step,
                                            limit.template band<T>(e), most, static_cast<T>(park));
    if (bound < most) exec::atomic_min(smallest, exec::ordered_bits(bound));
  }
  /// Most elements are within at the end of the motion, and need no more work.
  static constexpr int lanes = stretch_lanes<R, N>;
  void abreast(exec::Index first) const requires(lanes > 1) {
    if (before && *before == ~exec::Key{0}) return;
    const T most = static_cast<T>(before ? exec::from_ordered_bits(*before) : alpha);
    if (are_within(first, most)) return;
    for (int lane = 0; lane < lanes; ++lane) (*this)(first + lane);
  }

 private:
  bool are_within(exec::Index first, T most) const requires(lanes > 1) {
    TrianglesAbreast<T> triangles;
    for (int lane = 0; lane < lanes; ++lane) {
      Vec<T, 3> p[N + 1], step[N + 1];
      limit.points(x, first + lane, p);
      limit.points(dx, first + lane, step);
      for (int i = 0; i <= N; ++i) p[i] = p[i] + most * step[i];
      triangles.set(lane, p, limit.rest.template at<T>(first + lane, limit.n));
    }
    T sigma[2][lanes];
    stretches_abreast(triangles, sigma);
    bool within = true;
    for (int lane = 0; lane < lanes; ++lane) {
      const StrainBand<T> band = limit.template band<T>(first + lane);
      within = within && strain_gap(sigma[0][lane], band) > static_cast<T>(park) * band.width;
    }
    return within;
  }
};

// --- keys and sums (sum_kernels.hpp)
/// Largest change of the kappa of active elements.
template <int N>
struct LimitKappaChange {
  LimitColumns<N> limit;
  const double* before;
  BB_HD exec::Key operator()(exec::Index e) const {
    const bool active = limit.smallest_gap(e) < limit.band_width[e];
    return exec::largest_key(active ? relative_change(before[e], limit.kappa[e]) : 0.0);
  }
};
template <int N>
struct LimitParts {
  using Sum = LimitNumbers;
  LimitColumns<N> limit;
  BB_HD double load(exec::Index i, exec::Index e) const {
    using std::abs;
    const bool active = limit.gap[i] < limit.band_width[e];
    return active ? abs(limit.kappa[e] * limit.db[i]) / limit.rest.measure[e] : 0.0;
  }
  BB_HD void operator()(exec::Index e, LimitNumbers& sum) const {
    exec::raise_key(sum.stretch, ~exec::largest_key(limit.sigma[e]));
    for (int k = 0; k < N; ++k) exec::raise_key(sum.load, ~exec::largest_key(load(k * limit.n + e, e)));
    exec::raise_key(sum.gap, ~exec::smallest_key(limit.smallest_gap(e) / limit.band_width[e]));
  }
};

}  // namespace bb
