// All strain-limited triangles of a scene, or all tetrahedra: singular values, barrier terms, step bound, kappa policies.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "core/energy/local_terms.hpp"
#include "core/energy/strain_limit.hpp"
#include "core/energy/strain_stiffness.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Not an ElementFamily: its energy needs a barrier and kappa. One object a run; values, derivatives and
/// measure write its columns, so one caller at a time. `Barrier` is a BarrierFunction
/// (core/barrier/shape.hpp) or anything with its batch call eval(n, d, d_hat, b, db, d2b).
/// Rest: TriangleRest or TetrahedronRest.
template <class Rest>
class StrainLimitBatchOf {
 public:
  static constexpr int n_sigma = decltype(Rest::dm_inv)::ColsAtCompileTime;  // N
  static constexpr int n_points = n_sigma + 1;                               // P
  static constexpr std::size_t N = n_sigma, P = n_points;

  /// @param onset, width [n] 1, width > 0. ConfigError: columns of another length or value,
  /// elements without area or volume.
  /// @param planar of triangles: F is 2 x 2 in the x-y plane
  StrainLimitBatchOf(std::span<const std::array<int, P>> elements, const PositionsView& x_rest,
                     std::vector<double> onset, std::vector<double> width, bool planar = false,
                     Precision precision = Precision::full);

  std::string_view name() const { return "strain_limit"; }
  int width() const { return n_points; }
  std::size_t size() const { return bands_.size(); }
  std::span<const int> vertices() const { return vertices_; }
  std::span<const Rest> rests() const { return rests_; }
  /// Area (m^2) or volume (m^3) of an element at rest.
  double measure_of(std::size_t e) const { return rest_measure(rests_[e]); }

  /// Singular values and pseudo-gaps at x, kept in sigma() and gaps(). Cost: one SVD an element; only a
  /// comparison of positions when x is what was measured last.
  void measure(const PositionsView& x);
  /// How many states were measured.
  long long sweeps() const { return sweeps_; }
  std::span<const double> sigma() const { return sigma_; }  // [N n] descending in size within an element
  std::span<const double> gaps() const { return gap_; }     // [N n] y; d_hat of the shape is the width
  /// Smallest y of an element.
  double smallest_gap(std::size_t e) const { return *std::min_element(&gap_[N * e], &gap_[N * e] + N); }
  std::size_t n_active() const;  // elements with a stretch above 1 + onset
  double max_stretch() const;    // largest sigma - 1; 0 without elements
  double min_gap() const;        // smallest y; infinity without elements

  /// S_e [n], J; infinite at or beyond the limit. kappa [n], J. Measures.
  template <class Barrier>
  void values(const PositionsView& x, Barrier& barrier, const double* kappa, double* energy) {
    measure(x);
    evaluate(barrier);
    for (std::size_t e = 0; e < size(); ++e) {
      double sum = b_[N * e];
      for (std::size_t k = 1; k < N; ++k) sum += b_[N * e + k];
      energy[e] = kappa[e] * sum;
    }
  }
  /// Energies, gradients and Hessians; exact zeros where inactive, not finite at or beyond the limit.
  /// Measures.
  template <class Barrier>
  void derivatives(const PositionsView& x, Barrier& barrier, const double* kappa, Projection projection,
                   LocalTerms& out) {
    measure(x);
    evaluate(barrier);
    fill_terms(x, kappa, projection, out);
  }

  /// Largest alpha in [0, alpha_max] whose state x + alpha dx, rounded coordinate by coordinate, keeps every
  /// y above park x width (strain_step_bound). Does not depend on the number of threads. Cost: one SVD an
  /// element, about 60 more for those that would pass their limit.
  double step_bound(const PositionsView& x, const PositionsView& dx, double alpha_max = 1,
                    double park = 0) const;

  /// element_sums of every element, from which its policy makes kappa_e.
  /// @param x_start step start, m   @param hess [(3 P)^2 n] column-major; null: w^T H w is not asked for
  /// @param vertex_mass [n_vertices] kg   @param element_mass [n] kg
  void stiffness_sums(const PositionsView& x_start, const double* hess, const double* vertex_mass,
                      const double* element_mass, ElementSums<double>* sums) const;

 private:
  template <class T>
  T step_bound_in(const PositionsView& x, const PositionsView& dx, T alpha_max, T park) const;
  template <class Barrier>
  void evaluate(Barrier& barrier) {
    if constexpr (requires { barrier.literal; }) {
      if (barrier.literal) {
        barrier.eval(gap_.size(), gap_.data(), width_.data(), b_.data(), db_.data(), d2b_.data());
        return;
      }
    }
    for (std::size_t i = 0; i < gap_.size(); ++i) shape_gap_[i] = gap_[i] > 0 ? gap_[i] : width_[i];
    barrier.eval(gap_.size(), shape_gap_.data(), width_.data(), b_.data(), db_.data(), d2b_.data());
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < gap_.size(); ++i) {
      if (gap_[i] > 0) continue;
      b_[i] = d2b_[i] = infinity;
      db_[i] = -infinity;
    }
  }
  void fill_terms(const PositionsView& x, const double* kappa, Projection projection, LocalTerms& out) const;

  bool planar_;
  Positions measured_;  // what sigma_ and gap_ belong to
  long long sweeps_ = 0;
  std::vector<int> vertices_;
  std::vector<Rest> rests_;
  std::vector<StrainBand<double>> bands_;
  Precision precision_;
  std::vector<double> width_;         // [N n], all entries of an element equal
  std::vector<double> sigma_, gap_;   // [N n]
  std::vector<double> shape_gap_;     // [N n] gap_, or the width where the shape must not be asked
  std::vector<double> b_, db_, d2b_;  // [N n] for kappa = 1
};

using StrainLimitBatch = StrainLimitBatchOf<TriangleRest<double>>;
using SolidLimitBatch = StrainLimitBatchOf<TetrahedronRest<double>>;

}  // namespace bb
