// Loops over strain-limited triangles.
#include "core/energy/strain_limit_batch.hpp"

#include <tbb/parallel_reduce.h>

#include <algorithm>

#include "core/energy/element_loop.hpp"
#include "core/energy/membrane_batch.hpp"

namespace bb {

StrainLimitBatch::StrainLimitBatch(std::span<const std::array<int, 3>> triangles, const Positions& x_rest,
                                   std::vector<double> onset, std::vector<double> width, bool planar)
    : planar_(planar), rests_(triangle_rests(triangles, x_rest, planar)) {
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

void StrainLimitBatch::measure(const Positions& x) {
  if (x.cols() == measured_.cols() && x == measured_) return;
  measured_ = x;
  ++sweeps_;
  for_each_element(size(), [&](std::size_t e) {
    const Points<3> p(x, vertices_, e);
    const Vec2d sigma = planar_ ? membrane_svd(deformation_gradient<2>(rests_[e], p.x)).sigma
                                : membrane_svd(deformation_gradient<3>(rests_[e], p.x)).sigma;
    for (int k = 0; k < 2; ++k) {
      sigma_[2 * e + static_cast<std::size_t>(k)] = sigma[k];
      gap_[2 * e + static_cast<std::size_t>(k)] = strain_gap(sigma[k], bands_[e]);
    }
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

void StrainLimitBatch::fill_terms(const Positions& x, const double* kappa, Projection projection,
                                  LocalTerms& out) const {
  out.resize(size(), width());
  for_each_element(size(), [&](std::size_t e) {
    const Points<3> p(x, vertices_, e);
    const std::size_t i = 2 * e;
    const StrainShape<double> shape{{b_[i], b_[i + 1]}, {db_[i], db_[i + 1]}, {d2b_[i], d2b_[i + 1]}};
    const auto terms = [&]<int R>() {
      // an inactive element needs no SVD; its factors are not read
      const bool active = gap_[i] < width_[i];
      const Svd<double, R, 2> svd = active ? membrane_svd(deformation_gradient<R>(rests_[e], p.x))
                                           : Svd<double, R, 2>{{}, {sigma_[i], sigma_[i + 1]}, {}};
      return strain_limit_terms<R, double>(rests_[e], svd, bands_[e], shape, kappa[e], projection);
    };
    store_terms(planar_ ? terms.template operator()<2>() : terms.template operator()<3>(), e, out);
  });
}

double StrainLimitBatch::step_bound(const Positions& x, const Positions& dx, double alpha_max,
                                    double park) const {
  const auto smallest = [&](double alpha) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, size(), 64), alpha,
        [&](const tbb::blocked_range<std::size_t>& range, double bound) {
          for (std::size_t e = range.begin(); e < range.end(); ++e) {
            const Points<3> p(x, vertices_, e), step(dx, vertices_, e);
            bound = std::min(bound,
                             planar_ ? strain_step_bound<2>(rests_[e], p.x, step.x, bands_[e], alpha, park)
                                     : strain_step_bound<3>(rests_[e], p.x, step.x, bands_[e], alpha, park));
          }
          return bound;
        },
        [](double a, double b) { return std::min(a, b); });
  };
  // A second look: one element's bound may, by rounding alone, be beyond another's limit.
  for (double alpha = alpha_max;;) {
    const double bound = smallest(alpha);
    if (bound == alpha || bound == 0) return bound;
    alpha = bound;
  }
}

void StrainLimitBatch::fixed_stiffness(double k_s, double* kappa) const {
  for (std::size_t e = 0; e < size(); ++e) kappa[e] = k_s * rests_[e].area;
}

void StrainLimitBatch::elastic_stiffness(const Positions& x_start, const double* hess,
                                         const double* vertex_mass, const double* element_mass,
                                         const StrainStiffnessRule& rule, KappaParts* kappa) const {
  for_each_element(size(), [&](std::size_t e) {
    const Points<3> p(x_start, vertices_, e);
    const Mat<double, 9, 9> h = Eigen::Map<const Mat<double, 9, 9>>(hess + 81 * e);
    const int* v = vertices_.data() + 3 * e;
    const Vec3d mass(vertex_mass[v[0]], vertex_mass[v[1]], vertex_mass[v[2]]);
    kappa[e] = strain_stiffness<double>(p.x, h, mass, element_mass[e], width_[2 * e], rule);
  });
}

}  // namespace bb
