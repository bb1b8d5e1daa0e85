// Columns and launches of limited triangles and tetrahedra.
#include "core/energy/families/limit_family.hpp"

#include <algorithm>
#include <optional>

#include "core/barrier/folded_barrier.hpp"
#include "core/barrier/launches.hpp"
#include "core/energy/element_loop.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/limit_kernels.hpp"
#include "core/energy/rest_shapes.hpp"

namespace bb {
namespace {

using exec::Index, exec::Key;

/// What LimitShape does, of a shape or a scalar without kernels: stretches of a column by the shape's batch call. Of a host alone.
template <int N>
struct LimitBatch {
  static constexpr Index most = elements_of_a_thread, grain = 1;
  LimitColumns<N> limit;
  const BarrierFunction *barrier, *potential;  // potential: read where there are parts
  const KappaParts* parts;
  Index stretches() const { return (limit.n + most - 1) / most; }
  void operator()(Index item) const {
    const Index first = item % stretches() * most, begin = item / stretches() * limit.n + first;
    const auto m = static_cast<std::size_t>(std::min(most, limit.n - first));
    const double* width = limit.band_width + first;
    double *b = limit.b + begin, *db = limit.db + begin, *d2b = limit.d2b + begin;
    double gap[most], psi[3][most];
    const auto inside = [&](std::size_t i) {
      return barrier->literal || limit.gap[begin + static_cast<Index>(i)] > 0;
    };
    for (std::size_t i = 0; i < m; ++i)
      gap[i] = inside(i) ? limit.gap[begin + static_cast<Index>(i)] : width[i];
    barrier->eval(m, gap, width, b, db, d2b);
    if (parts) potential->eval(m, gap, width, psi[0], psi[1], psi[2]);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < m; ++i) {
      ShapeTerms<double> terms{b[i], db[i], d2b[i]};
      if (parts) {
        terms = folded_row<double>(terms, {psi[0][i], psi[1][i], psi[2][i]},
                                   parts[first + static_cast<Index>(i)], width[i]);
      }
      b[i] = inside(i) ? terms.b : infinity;
      db[i] = inside(i) ? terms.db : -infinity;
      d2b[i] = inside(i) ? terms.d2b : infinity;
    }
  }
};
template <int N>
struct FinishMeasure {
  LimitColumns<N> limit;
  MeasureAt at;
  void operator()(Index e) const { finish_measure(limit, at, e); }
};

/// Names of the buffers.
struct LimitNames {
  const char *vertices, *rest_shapes;
};

/// R: 3 in space, 2 in the x-y plane. N: 2 singular values of triangles, 3 of tetrahedra.
template <int R, int N>
class LimitFamilyOf final : public FamilyOf<Limit<R, N>, LimitFamily> {
  using Base = FamilyOf<Limit<R, N>, LimitFamily>;
  using Base::elements_, Base::place_, Base::executor_, Base::kappa_, Base::least_, Base::sweeps_;

 public:
  LimitFamilyOf(const FamilyPlace& place, const LimitNames& names,
                std::span<const std::array<int, N + 1>> elements, std::span<const LimitedRest<N>> rests,
                const StrainBands& bands)
      : Base(place, names.vertices, elements, place.executor),
        bands_(bands),
        shapes_(executor_, names.rest_shapes, rests),
        band_(executor_, "limit bands"),
        mass_(executor_, "limit element masses"),
        state_(executor_, "limit stretches and barrier terms", 5 * N * elements_.n),
        before_(executor_, "limit stiffness before"),
        parts_(executor_, "limit stiffness parts") {
    upload_pair(bands.onset, bands.width, band_);
    kappa_.resize(elements_.n);
    kappa_.fill_zero();
    elements_.rest = shapes_.rest();
    elements_.onset = band_.data(), elements_.band_width = band_.data() + elements_.n;
    double* column = state_.data();
    for (double** of : {&elements_.sigma, &elements_.gap, &elements_.b, &elements_.db, &elements_.d2b}) {
      *of = column;
      column += N * elements_.n;
    }
    elements_.kappa = kappa_.data();
  }

  void measure(const double* x) override {
    ++sweeps_;
    with_value_scalar(place_.precision, [&]<class T>() {
      executor_.each(elements_.n, MeasureStretch<R, N, T>{elements_, x});
    });
  }
  void fill_barrier(const BarrierFunction& barrier) override {
    if (const auto* launches = launches_of(barrier)) {
      return launches->terms(executor_, elements_, barrier, parts());
    }
    if (parts() && !potential_) potential_ = potential_of(barrier);
    const LimitBatch<N> batch{elements_, &barrier, potential_ ? &*potential_ : nullptr, parts()};
    executor_.each(N * batch.stretches(), batch);
  }
  void measure(const double* x, const BarrierFunction& barrier, double* energy, Key* beyond) override {
    const MeasureAt at{x, energy, beyond};
    if (const auto* launches = launches_of(barrier)) {
      ++sweeps_;
      return launches->measure(executor_, elements_, barrier, parts(), at);
    }
    measure(x);
    fill_barrier(barrier);
    executor_.each(elements_.n, FinishMeasure<N>{elements_, at});
  }

  void make_kappa(const StiffnessPolicy& policy, const KappaSources& from) override {
    parts_.resize(policy.has_potential() ? elements_.n : 0);
    launch_kappa(policy, from);
  }
  std::vector<double> kappa_at(std::span<const double> gaps, const StiffnessPolicy& policy,
                               const KappaSources& from) override {
    for (int k = 0; k < N; ++k) std::copy(gaps.begin(), gaps.end(), elements_.gap + k * elements_.n);
    parts_.resize(0);
    launch_kappa(policy, from);
    return kappa_.download();
  }
  double kappa_change() override {
    least_.clear();
    least_.add(elements_.n, LimitKappaChange<N>{elements_, before_.data()});
    return least_.largest();
  }

  double smallest_gap(std::size_t e) const override { return elements_.smallest_gap(static_cast<Index>(e)); }
  double measure_of(std::size_t e) const override { return elements_.rest.measure[e]; }

 protected:
  void launch_bound(const double* x, const double* dx, double alpha, double park, const Key* before,
                    Key* smallest) override {
    with_value_scalar(place_.precision, [&]<class T>() {
      executor_.each(elements_.n, StretchBound<R, N, T>{elements_, x, dx, alpha, park, before, smallest});
    });
  }
  void add_numbers(exec::ExecutorSums<LimitNumbers>& numbers) override {
    numbers.add(elements_.n, LimitParts<N>{elements_});
  }

 private:
  void launch_kappa(const StiffnessPolicy& policy, const KappaSources& from) {
    if (!policy.uniform() && before_.size() == 0) {
      mass_.upload(bands_.mass);
      before_.resize(elements_.n);
    }
    const ElementKappaInputs<N> of{elements_, policy.needs_hessian(), from, mass_.data(),
                                   parts(),   before_.data()};
    if constexpr (N == 3) {
      policy.launches()->tetrahedra(executor_, policy, of);
    } else {
      policy.launches()->triangles(executor_, policy, of);
    }
  }
  /// Null where the folded kappa is a number.
  KappaParts* parts() { return parts_.size() > 0 ? parts_.data() : nullptr; }
  /// Null where shape or scalar have no kernels.
  static const LimitLaunches<N>* launches_of(const BarrierFunction& barrier) {
    if (barrier.in_float || !barrier.shape.launches) return nullptr;
    const ShapeLaunches& all = *barrier.shape.launches;
    if constexpr (N == 3) {
      return &all.tetrahedra;
    } else {
      return R == 2 ? &all.planar_triangles : &all.triangles;
    }
  }

  const StrainBands& bands_;
  RestShapes<LimitedRest<N>> shapes_;
  exec::Buffer<double> band_, mass_, state_, before_;
  exec::Buffer<KappaParts> parts_;
  std::optional<BarrierFunction> potential_;
};

template <int R, int N>
std::unique_ptr<LimitFamily> limited(const FamilyPlace& place, const LimitNames& names,
                                     std::span<const std::array<int, N + 1>> elements,
                                     std::span<const LimitedRest<N>> rests, const StrainBands& bands) {
  check_column("strain_limit/onset", elements.size(), bands.onset, false);
  check_column("strain_limit/width", elements.size(), bands.width, true);
  return std::make_unique<LimitFamilyOf<R, N>>(place, names, elements, rests, bands);
}

}  // namespace

// A second look: one element's bound may, by rounding alone, be beyond another's limit.
void LimitFamily::look_along(const double* x, const double* dx, double park, double alpha_max) {
  motion_ = {x, dx, park, alpha_max};
  bounds_.fill(0xff);
  launch_bound(x, dx, alpha_max, park, nullptr, &bounds_.to_write()->first);
  launch_bound(x, dx, alpha_max, park, &bounds_.data()->first, &bounds_.to_write()->second);
}

double LimitFamily::bound() {
  using exec::ExecutorLeast;
  if (executor_.counts_only()) return motion_.alpha_max;
  const Bounds found = bounds_.get();
  if (found.first == ExecutorLeast::none) return motion_.alpha_max;
  double alpha = exec::from_ordered_bits(found.first);
  for (Key key = found.second; key != ExecutorLeast::none && alpha != 0; key = least_.get()) {
    alpha = exec::from_ordered_bits(key);
    least_.clear();
    launch_bound(motion_.x, motion_.dx, alpha, motion_.park, nullptr, least_.data());
  }
  return alpha;
}

std::vector<double> LimitFamily::smallest_gaps(const double* x) {
  measure(x);
  std::vector<double> out(static_cast<std::size_t>(size()));
  for (std::size_t e = 0; e < out.size(); ++e) out[e] = smallest_gap(e);
  return out;
}

void LimitFamily::announce() {
  numbers_.clear();
  add_numbers(numbers_);
}

LimitReport LimitFamily::report() const {
  const LimitNumbers found = numbers_.get();
  return {exec::largest_of(found.stretch) - 1, exec::largest_of(found.load), exec::smallest_of(found.gap)};
}

std::unique_ptr<LimitFamily> limited_triangles(const FamilyPlace& place, const StrainLimitPart& part,
                                               const PositionsView& x_rest, bool planar) {
  const LimitNames names{"limit vertices", "limit rest shapes"};
  const std::vector<TriangleRest<double>> rests = triangle_rests(part.triangles, x_rest, planar);
  return planar ? limited<2, 2>(place, names, part.triangles, rests, part)
                : limited<3, 2>(place, names, part.triangles, rests, part);
}

std::unique_ptr<LimitFamily> limited_tetrahedra(const FamilyPlace& place, const SolidLimitPart& part,
                                                const PositionsView& x_rest) {
  return limited<3, 3>(place, {"solid limit vertices", "solid limit rest shapes"}, part.tetrahedra,
                       tetrahedron_rests(part.tetrahedra, x_rest), part);
}

}  // namespace bb
