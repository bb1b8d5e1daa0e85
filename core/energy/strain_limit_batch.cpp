// Loops over strain-limited triangles and tetrahedra.
#include "core/energy/strain_limit_batch.hpp"

#include <algorithm>

#include "core/energy/element_loop.hpp"
#include "core/energy/rest_shapes.hpp"

namespace bb {
namespace {

template <class T>
StrainBand<T> band_in(const StrainBand<double>& band) {
  return {static_cast<T>(band.onset), static_cast<T>(band.width)};
}

/// N numbers from `column` on.
template <class T, int N>
Vec<T, N> numbers_in(const double* column) {
  return Eigen::Map<const Vec<double, N>>(column).template cast<T>();
}

std::vector<TriangleRest<double>> rests_of(std::span<const std::array<int, 3>> triangles,
                                           const PositionsView& x_rest, bool planar) {
  return triangle_rests(triangles, x_rest, planar);
}
std::vector<TetrahedronRest<double>> rests_of(std::span<const std::array<int, 4>> tetrahedra,
                                              const PositionsView& x_rest, bool) {
  return tetrahedron_rests(tetrahedra, x_rest);
}

/// f.operator()<R>(), R the rows of F.
template <int N, class F>
decltype(auto) with_rows(bool planar, const F& f) {
  if constexpr (N == 2) {
    if (planar) return f.template operator()<2>();
  }
  return f.template operator()<3>();
}

}  // namespace

template <class Rest>
StrainLimitBatchOf<Rest>::StrainLimitBatchOf(std::span<const std::array<int, P>> elements,
                                             const PositionsView& x_rest, std::vector<double> onset,
                                             std::vector<double> width, bool planar, Precision precision)
    : planar_(planar), rests_(rests_of(elements, x_rest, planar)), precision_(precision) {
  const std::size_t n = elements.size();
  check_column("strain_limit/onset", n, onset, false);
  check_column("strain_limit/width", n, width, true);
  for (std::size_t e = 0; e < n; ++e) {
    vertices_.insert(vertices_.end(), elements[e].begin(), elements[e].end());
    bands_.push_back({onset[e], width[e]});
    width_.insert(width_.end(), N, width[e]);
  }
  for (std::vector<double>* column : {&sigma_, &gap_, &shape_gap_, &b_, &db_, &d2b_})
    column->assign(N * n, 0.0);
}

template <class Rest>
void StrainLimitBatchOf<Rest>::measure(const PositionsView& x) {
  if (x.cols() == measured_.cols() && x == measured_) return;
  measured_ = x;
  ++sweeps_;
  with_value_scalar(precision_, [&]<class T>() {
    for_each_element(size(), [&](std::size_t e) {
      const Points<n_points, T> p(x, vertices_, e);
      const auto rest = rest_in<T>(rests_[e]);
      const Vec<T, n_sigma> sigma = with_rows<n_sigma>(planar_, [&]<int R>() -> Vec<T, n_sigma> {
        return signed_svd(deformation_gradient<R>(rest, p.x)).sigma;
      });
      for (int k = 0; k < n_sigma; ++k) {
        sigma_[N * e + static_cast<std::size_t>(k)] = sigma[k];
        gap_[N * e + static_cast<std::size_t>(k)] = stretch_gap(sigma[k], band_in<T>(bands_[e]));
      }
    });
  });
}

template <class Rest>
std::size_t StrainLimitBatchOf<Rest>::n_active() const {
  std::size_t n = 0;
  for (std::size_t e = 0; e < size(); ++e) n += gap_[N * e] < width_[N * e] ? 1 : 0;
  return n;
}

template <class Rest>
double StrainLimitBatchOf<Rest>::max_stretch() const {
  return sigma_.empty() ? 0.0 : *std::max_element(sigma_.begin(), sigma_.end()) - 1;
}

template <class Rest>
double StrainLimitBatchOf<Rest>::min_gap() const {
  return gap_.empty() ? std::numeric_limits<double>::infinity() : *std::min_element(gap_.begin(), gap_.end());
}

template <class Rest>
void StrainLimitBatchOf<Rest>::fill_terms(const PositionsView& x, const double* kappa, Projection projection,
                                          LocalTerms& out) const {
  out.resize(size(), width());
  const auto terms = [&]<class T>(std::size_t e) {
    const Points<n_points, T> p(x, vertices_, e);
    const std::size_t i = N * e;
    const StrainShape<T, n_sigma> shape{numbers_in<T, n_sigma>(&b_[i]), numbers_in<T, n_sigma>(&db_[i]),
                                        numbers_in<T, n_sigma>(&d2b_[i])};
    const auto rest = rest_in<T>(rests_[e]);
    return with_rows<n_sigma>(planar_, [&]<int R>() {
      // an inactive element needs no SVD; its factors are not read
      const bool active = gap_[i] < width_[i];
      const Svd<T, R, n_sigma> svd = active ? signed_svd(deformation_gradient<R>(rest, p.x))
                                            : Svd<T, R, n_sigma>{{}, numbers_in<T, n_sigma>(&sigma_[i]), {}};
      return strain_limit_terms<R, T>(rest, svd, band_in<T>(bands_[e]), shape, static_cast<T>(kappa[e]),
                                      projection);
    });
  };
  store_elements(size(), precision_, terms, out);
}

template <class Rest>
double StrainLimitBatchOf<Rest>::step_bound(const PositionsView& x, const PositionsView& dx, double alpha_max,
                                            double park) const {
  return with_value_scalar(precision_, [&]<class T>() -> double {
    return step_bound_in<T>(x, dx, static_cast<T>(alpha_max), static_cast<T>(park));
  });
}

template <class Rest>
template <class T>
T StrainLimitBatchOf<Rest>::step_bound_in(const PositionsView& x, const PositionsView& dx, T alpha_max,
                                          T park) const {
  const auto smallest = [&](T alpha) {
    return reduce_items(
        size(), 64, alpha,
        [&](std::size_t begin, std::size_t end, T bound) {
          for (std::size_t e = begin; e < end; ++e) {
            const Points<n_points, T> p(x, vertices_, e), step(dx, vertices_, e);
            const auto rest = rest_in<T>(rests_[e]);
            const StrainBand<T> band = band_in<T>(bands_[e]);
            bound = std::min(bound, with_rows<n_sigma>(planar_, [&]<int R>() {
                               return strain_step_bound<R>(rest, p.x, step.x, band, alpha, park);
                             }));
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

template <class Rest>
void StrainLimitBatchOf<Rest>::stiffness_sums(const PositionsView& x_start, const double* hess,
                                              const double* vertex_mass, const double* element_mass,
                                              ElementSums<double>* sums) const {
  constexpr int size_of_block = 3 * n_points;
  for_each_element(size(), [&](std::size_t e) {
    const Points<n_points> p(x_start, vertices_, e);
    const int* v = vertices_.data() + P * e;
    Vec<double, n_points> mass;
    for (int k = 0; k < n_points; ++k) mass[k] = vertex_mass[v[k]];
    const auto hessian = [&] {
      using Block = Mat<double, size_of_block, size_of_block>;
      return Block(Eigen::Map<const Block>(hess + Block::SizeAtCompileTime * static_cast<std::ptrdiff_t>(e)));
    };
    sums[e] = element_sums<double>(p.x, mass, element_mass[e], measure_of(e), hessian, hess != nullptr);
  });
}

template class StrainLimitBatchOf<TriangleRest<double>>;
template class StrainLimitBatchOf<TetrahedronRest<double>>;

}  // namespace bb
