// Loops over strain-limited triangles.
#include "core/energy/strain_limit_batch.hpp"

#include <tbb/parallel_reduce.h>

#include <algorithm>

#include "core/energy/element_loop.hpp"
#include "core/energy/membrane_batch.hpp"

namespace bb {
namespace {

template <class T>
StrainBand<T> band_in(const StrainBand<double>& band) {
  return {static_cast<T>(band.onset), static_cast<T>(band.width)};
}

/// Two numbers from `column` on.
template <class T>
Vec<T, 2> two_in(const double* column) {
  return {static_cast<T>(column[0]), static_cast<T>(column[1])};
}

}  // namespace

StrainLimitBatch::StrainLimitBatch(std::span<const std::array<int, 3>> triangles, const PositionsView& x_rest,
                                   std::vector<double> onset, std::vector<double> width, bool planar,
                                   Precision precision)
    : planar_(planar), rests_(triangle_rests(triangles, x_rest, planar)), precision_(precision) {
  const std::size_t n = triangles.size();
  check_column("strain_limit/onset", n, onset, false);
  check_column("strain_limit/width", n, width, true);
  for (std::size_t e = 0; e < n; ++e) {
    vertices_.insert(vertices_.end(), triangles[e].begin(), triangles[e].end());
    bands_.push_back({onset[e], width[e]});
    width_.insert(width_.end(), 2, width[e]);
  }
  for (std::vector<double>* column : {&sigma_, &gap_, &shape_gap_, &b_, &db_, &d2b_})
    column->assign(2 * n, 0.0);
}

void StrainLimitBatch::measure(const PositionsView& x) {
  if (x.cols() == measured_.cols() && x == measured_) return;
  measured_ = x;
  ++sweeps_;
  with_value_scalar(precision_, [&]<class T>() {
    for_each_element(size(), [&](std::size_t e) {
      const Points<3, T> p(x, vertices_, e);
      const TriangleRest<T> rest = rest_in<T>(rests_[e]);
      const Vec<T, 2> sigma = planar_ ? signed_svd(deformation_gradient<2>(rest, p.x)).sigma
                                      : signed_svd(deformation_gradient<3>(rest, p.x)).sigma;
      for (int k = 0; k < 2; ++k) {
        sigma_[2 * e + static_cast<std::size_t>(k)] = sigma[k];
        gap_[2 * e + static_cast<std::size_t>(k)] = strain_gap(sigma[k], band_in<T>(bands_[e]));
      }
    });
  });
}

std::size_t StrainLimitBatch::n_active() const {
  std::size_t n = 0;
  for (std::size_t e = 0; e < size(); ++e) n += gap_[2 * e] < width_[2 * e] ? 1 : 0;
  return n;
}

double StrainLimitBatch::max_stretch() const {
  return sigma_.empty() ? 0.0 : *std::max_element(sigma_.begin(), sigma_.end()) - 1;
}

double StrainLimitBatch::min_gap() const {
  return gap_.empty() ? std::numeric_limits<double>::infinity() : *std::min_element(gap_.begin(), gap_.end());
}

void StrainLimitBatch::fill_terms(const PositionsView& x, const double* kappa, Projection projection,
                                  LocalTerms& out) const {
  out.resize(size(), width());
  const auto terms = [&]<class T>(std::size_t e) {
    const Points<3, T> p(x, vertices_, e);
    const std::size_t i = 2 * e;
    const StrainShape<T> shape{two_in<T>(&b_[i]), two_in<T>(&db_[i]), two_in<T>(&d2b_[i])};
    const TriangleRest<T> rest = rest_in<T>(rests_[e]);
    const auto in_dimension = [&]<int R>() {
      // an inactive element needs no SVD; its factors are not read
      const bool active = gap_[i] < width_[i];
      const Svd<T, R, 2> svd = active ? signed_svd(deformation_gradient<R>(rest, p.x))
                                      : Svd<T, R, 2>{{}, two_in<T>(&sigma_[i]), {}};
      return strain_limit_terms<R, T>(rest, svd, band_in<T>(bands_[e]), shape, static_cast<T>(kappa[e]),
                                      projection);
    };
    return planar_ ? in_dimension.template operator()<2>() : in_dimension.template operator()<3>();
  };
  store_elements(size(), precision_, terms, out);
}

double StrainLimitBatch::step_bound(const PositionsView& x, const PositionsView& dx, double alpha_max,
                                    double park) const {
  return with_value_scalar(precision_, [&]<class T>() -> double {
    return step_bound_in<T>(x, dx, static_cast<T>(alpha_max), static_cast<T>(park));
  });
}

template <class T>
T StrainLimitBatch::step_bound_in(const PositionsView& x, const PositionsView& dx, T alpha_max,
                                  T park) const {
  const auto smallest = [&](T alpha) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, size(), 64), alpha,
        [&](const tbb::blocked_range<std::size_t>& range, T bound) {
          for (std::size_t e = range.begin(); e < range.end(); ++e) {
            const Points<3, T> p(x, vertices_, e), step(dx, vertices_, e);
            const TriangleRest<T> rest = rest_in<T>(rests_[e]);
            const StrainBand<T> band = band_in<T>(bands_[e]);
            bound = std::min(bound, planar_ ? strain_step_bound<2>(rest, p.x, step.x, band, alpha, park)
                                            : strain_step_bound<3>(rest, p.x, step.x, band, alpha, park));
          }
          return bound;
        },
        [](T a, T b) { return std::min(a, b); });
  };
  // A second look: one element's bound may, by rounding alone, be beyond another's limit.
  for (T alpha = alpha_max;;) {
    const T bound = smallest(alpha);
    if (bound == alpha || bound == 0) return bound;
    alpha = bound;
  }
}

void StrainLimitBatch::stiffness_sums(const PositionsView& x_start, const double* hess,
                                      const double* vertex_mass, const double* element_mass,
                                      ElementSums<double>* sums) const {
  for_each_element(size(), [&](std::size_t e) {
    const Points<3> p(x_start, vertices_, e);
    const int* v = vertices_.data() + 3 * e;
    const Vec3d mass(vertex_mass[v[0]], vertex_mass[v[1]], vertex_mass[v[2]]);
    const auto hessian = [&] {
      return Mat<double, 9, 9>(Eigen::Map<const Mat<double, 9, 9>>(hess + 81 * e));
    };
    sums[e] = element_sums<double>(p.x, mass, element_mass[e], rests_[e].area, hessian, hess != nullptr);
  });
}

}  // namespace bb
