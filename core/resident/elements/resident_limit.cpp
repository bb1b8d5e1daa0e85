#include "core/resident/elements/resident_limit.hpp"

#include "barriers/shapes/shape_list.hpp"
#include "barriers/stiffness/item_policy.hpp"
#include "barriers/stiffness/policy_list.hpp"
#include "core/energy/strain_limit_batch.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/limit_kernels.hpp"
#include "core/resident/elements/triangle_columns.hpp"

namespace bb::resident {
namespace {

using LaunchShape = void (*)(exec::Executor&, const LimitColumns&, const BarrierFunction&, const KappaParts*);

template <class S>
void launch_shape(exec::Executor& executor, const LimitColumns& limit, const BarrierFunction& barrier,
                  const KappaParts* parts) {
  executor.each(2 * limit.n, LimitShape<S>{limit, barrier.argument, barrier.literal, parts});
}

LaunchShape shape_kernel(const BarrierFunction& barrier) {
#define SHAPE(id, Struct) \
  if (barrier.shape.name == #id && !barrier.shape.self) return &launch_shape<shapes::Struct>;
  BB_FOR_EACH_SHAPE(SHAPE)
#undef SHAPE
  throw ConfigError("shape", barrier.shape.name,
                    "a shape of barriers/shapes: a plugin's and another exponent have no kernel");
}

template <int R>
class LimitFamily final : public FamilyOf<Limit<R>, ResidentLimit> {
  using Family = FamilyOf<Limit<R>, ResidentLimit>;
  using Family::elements_, Family::executor_;

 public:
  using Family::size;
  LimitFamily(exec::Executor& executor, const Scene& scene, const TermOptions& options,
              const StrainLimitBatch& batch)
      : Family(executor, "strain_limit", TermGroup::limit),
        options_(options),
        launch_shape_(shape_kernel(options.limit)),
        triangles_(executor, "limit", batch.vertices(), batch.rests()),
        band_(executor, "limit bands"),
        mass_(executor, "limit element masses"),
        state_(executor, "limit stretches and barrier terms", 10 * n_of(batch)),
        kappa_(executor, "limit stiffness", n_of(batch)),
        before_(executor, "limit stiffness before"),
        parts_(executor, "limit stiffness parts"),
        least_(executor),
        numbers_(executor) {
    LimitPolicies::require(policy(), "stiffness_policy/name");
    std::vector<double> band = scene.limit.onset;
    band.insert(band.end(), scene.limit.width.begin(), scene.limit.width.end());
    band_.upload(band);
    if (!policy().uniform()) {
      mass_.upload(scene.limit.mass);
      before_.resize(n_of(batch));
    }
    if (policy().has_potential()) parts_.resize(n_of(batch));
    set_columns(n_of(batch));
  }

  void measure(const double* x) override {
    measure_stretch(x);
    fill_barrier();
  }
  void begin_step() override { fresh_ = false, first_ = true; }
  bool reads_elastic() const override { return policy().needs_hessian() && !keeps(); }
  double refresh(const double* x, const ResidentFrame& frame, const double* mass,
                 const MatrixPart& elastic) override;
  bool feasible() override {
    if (options_.limit.literal) return true;
    least_.clear();
    executor_.each(size(), FirstBeyondLimit{elements_, least_.data()});
    return least_.first() < 0;
  }
  double bound(const double* x, const double* dx, double park) override;
  LimitNumbers numbers() override;

 private:
  static Index n_of(const StrainLimitBatch& batch) { return static_cast<Index>(batch.size()); }
  const StiffnessPolicy& policy() const { return *options_.limit_stiffness; }
  void fill_kappa(const ResidentFrame& frame, const double* mass, const MatrixPart& elastic);
  /// Whether kappa stays at the next refresh.
  bool keeps() const { return fresh_ && policy().frozen_in_step(); }
  void measure_stretch(const double* x) { executor_.each(size(), MeasureStretch<R>{elements_, x}); }
  /// Barrier terms at the measured pseudo-gaps.
  void fill_barrier() {
    launch_shape_(executor_, elements_, options_.limit, policy().has_potential() ? parts_.data() : nullptr);
  }
  void set_columns(Index n) {
    elements_.of = triangles_.vertex.data();
    elements_.n = n;
    elements_.rest = triangles_.rest();
    elements_.onset = band_.data(), elements_.band_width = band_.data() + n;
    double* column = state_.data();
    for (double** pointer : {&elements_.sigma, &elements_.gap, &elements_.b, &elements_.db, &elements_.d2b}) {
      *pointer = column;
      column += 2 * n;
    }
    elements_.kappa = kappa_.data();
  }

  const TermOptions& options_;
  LaunchShape launch_shape_;
  TriangleColumns triangles_;
  Buffer<double> band_, mass_, state_, kappa_, before_;
  Buffer<KappaParts> parts_;
  ResidentLeast least_;
  ResidentLeasts<3> numbers_;
  bool fresh_ = false, first_ = true;  // kappa is that of this step; no iterate of the step was refreshed
};

template <int R>
double LimitFamily<R>::refresh(const double* x, const ResidentFrame& frame, const double* mass,
                               const MatrixPart& elastic) {
  const bool first = first_, keep = keeps();
  first_ = false, fresh_ = true;
  measure_stretch(x);
  if (!keep) fill_kappa(frame, mass, elastic);
  fill_barrier();
  if (keep || first || policy().uniform() || policy().has_potential()) return 0;
  least_.clear();
  least_.add(size(), LimitKappaChange{elements_, before_.data()});
  return least_.largest();
}

template <int R>
void LimitFamily<R>::fill_kappa(const ResidentFrame& frame, const double* mass, const MatrixPart& elastic) {
  KappaParts* const parts = policy().has_potential() ? parts_.data() : nullptr;
  LimitPolicies::with(policy(), [&]<class P>(const ScaledPolicy<P>& values) {
    executor_.each(size(), ElementKappa<P>{elements_,
                                           values,
                                           policy().needs_hessian(),
                                           {frame.dt, frame.c},
                                           frame.x_n,
                                           mass,
                                           mass_.data(),
                                           elastic,
                                           parts,
                                           before_.data()});
  });
}

template <int R>
double LimitFamily<R>::bound(const double* x, const double* dx, double park) {
  if (executor_.counts_only()) return 1;
  // A second look: one element's bound may, by rounding alone, be beyond another's limit.
  for (double alpha = 1;;) {
    least_.clear(exec::ordered_bits(alpha));
    executor_.each(size(), StretchBound<R>{elements_, x, dx, alpha, park, least_.data()});
    const double bound = exec::from_ordered_bits(least_.get());
    if (bound == alpha || bound == 0) return bound;
    alpha = bound;
  }
}

template <int R>
LimitNumbers LimitFamily<R>::numbers() {
  numbers_.clear();
  numbers_.add(0, size(), LimitStretch{elements_});
  numbers_.add(1, 2 * size(), LimitLoad{elements_});
  numbers_.add(2, size(), LimitRelativeGap{elements_});
  const auto least = numbers_.get();
  LimitNumbers out;
  out.max_stretch = least.largest(0) - 1;
  out.load_max = least.largest(1);
  out.gap_min_rel = least.smallest(2);
  return out;
}

}  // namespace

std::unique_ptr<ResidentLimit> make_limit(exec::Executor& executor, const Scene& scene,
                                          const TermOptions& options, std::vector<int>& vertices) {
  const StrainLimitPart& part = scene.limit;
  if (!options.strain_limit || part.triangles.empty()) return nullptr;
  const StrainLimitBatch batch(part.triangles, scene.rest, part.onset, part.width, scene.planar);
  vertices.assign(batch.vertices().begin(), batch.vertices().end());
  if (scene.planar) return std::make_unique<LimitFamily<2>>(executor, scene, options, batch);
  return std::make_unique<LimitFamily<3>>(executor, scene, options, batch);
}

}  // namespace bb::resident
