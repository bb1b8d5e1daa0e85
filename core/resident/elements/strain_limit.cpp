// The strain limit on an executor, one term of triangles and one of tetrahedra: a family of elements whose barrier and
// stiffness change with the state.
#include <algorithm>
#include <type_traits>

#include "core/barrier/launches.hpp"
#include "core/energy/strain_limit_batch.hpp"
#include "core/math/error.hpp"
#include "core/energy/families/element_columns.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/limit_forms.hpp"
#include "core/resident/elements/limit_kernels.hpp"

namespace bb::resident {
namespace {

template <int R, int N>
const LimitLaunches<N>& launches_of(const ShapeLaunches& all) {
  if constexpr (N == 3) {
    return all.tetrahedra;
  } else {
    return R == 2 ? all.planar_triangles : all.triangles;
  }
}

template <int N>
using LimitPartOf = std::conditional_t<N == 2, StrainLimitPart, SolidLimitPart>;

/// What everything but the sums is computed from is measured: singular values, pseudo-gaps and barrier terms of one state.
/// R: 3 in space, 2 in the x-y plane. N: 2 singular values of triangles, 3 of tetrahedra.
template <int R, int N>
class LimitTerm final : public TermOf<Limit<R, N>> {
  using Base = TermOf<Limit<R, N>>;
  static constexpr bool of_solids = N == 3;
  using Batch = StrainLimitBatchOf<LimitedRest<N>>;
  using Base::elements_, Base::executor_, Base::size;

 public:
  LimitTerm(const ResidentInputs& inputs, const Batch& batch, const LimitPartOf<N>& part);

  void begin_step(const ResidentFrame& frame) override {
    fresh_ = false, first_ = true;
    announced_ = accepted_ = false;
    measured_ = State::none;
    x_n_ = frame.x_n->data();
    change_frame(frame);
  }
  void change_frame(const ResidentFrame& frame) override { time_ = {frame.dt, frame.c}; }

  void linearise(const Column& x, const ResidentContext& context, Column& g) override {
    refresh(x, context.elastic);
    Base::linearise(x, context, g);
  }
  void add_matrix(const Column& x, const HessianRequest& request) override {
    measure_iterate(x);
    Base::add_matrix(x, request);
  }

  void look_along(const ResidentMotion& motion, PhaseClock& clock) override;
  double bound(const ResidentMotion& motion, IterateNumbers& out, PhaseClock& clock) override;
  std::string describe_bound() const override {
    return of_solids ? "the strain limit of solids" : "the strain limit";
  }
  void look_at(const Column&, const Column& trial, PhaseClock&) override {
    measure(trial, Base::trial_energies(), State::trial);
  }
  bool admits(const Column& x, const Column& trial, PhaseClock& clock) override;
  void evaluate(const Column& trial) override {
    if (measured_ != State::trial)
      measure(trial, Base::trial_energies(), State::trial);  // the iterate was asked for since
  }
  void evaluate_iterate(const Column& x) override {
    measure_iterate(x);
    Base::evaluate_iterate(x);
  }
  void accept() override {
    announced_ = false;
    accepted_ = measured_ == State::trial;
    measured_ = accepted_ ? State::iterate : State::none;
  }

  void announce(const Column& x) override;
  void report(const Column& x, IterateNumbers& out, PhaseClock& clock) override;
  void report_end(const Column& x, StepNumbers& out) override;

 private:
  enum class State { none, iterate, trial };
  /// Ordered bits of the smallest bound, and of the smallest of a second look that begins with it; all ones: none.
  struct Bounds {
    Key first, second;
  };
  struct Numbers {
    double max_stretch, load_max, gap_min_rel;  // 1, N/m or Pa, 1: of the width
  };

  const StiffnessPolicy& policy() const {
    return of_solids ? *options_.solid_limit_stiffness : *options_.limit_stiffness;
  }
  KappaParts* parts() { return policy().has_potential() ? parts_.data() : nullptr; }
  void set_columns(Index n);
  void refresh(const Column& x, const MatrixPart& elastic);
  void fill_kappa(const MatrixPart& elastic);
  Numbers numbers(const Column& x);
  template <class Out>
  void say_state(const Numbers& found, Out& out) const;
  void measure_stretch(const Column& x) { executor_.each(size(), MeasureStretch<R, N>{elements_, x.data()}); }
  /// Barrier terms at the measured pseudo-gaps.
  void fill_barrier() { launches_.terms(executor_, elements_, options_.limit, parts()); }
  void measure_iterate(const Column& x) {
    if (measured_ != State::iterate) measure(x, Base::energies(), State::iterate);
  }
  /// Stretches, barrier terms and energies at x, with the kappa that there is.
  void measure(const Column& x, double* energy, State state) {
    beyond_.clear();
    launches_.measure(executor_, elements_, options_.limit, parts(), {x.data(), energy, beyond_.data()});
    measured_ = state;
    announced_ = false;
  }

  const TermOptions& options_;
  const Buffer<double>& vertex_mass_;
  const LimitLaunches<N>& launches_;
  const bool adds_;  // triangles have said their part of what is reported before
  Buffer<int> vertex_;
  RestShapes<LimitedRest<N>> shapes_;
  Buffer<double> band_, mass_, state_, kappa_, before_;
  Buffer<KappaParts> parts_;
  ResidentLeast least_, beyond_;
  exec::Reading<Bounds> bounds_;
  ResidentSums<LimitNumbers> numbers_;
  StiffnessTime time_;
  const double* x_n_ = nullptr;
  State measured_ = State::none;
  bool accepted_ = false;              // the iterate was a trial, and was not linearised yet
  bool announced_ = false;             // numbers_ is of the iterate
  bool fresh_ = false, first_ = true;  // kappa is that of this step; no iterate of the step was refreshed
  double kappa_change_ = 0;            // of the last linearise()
};

template <int R, int N>
LimitTerm<R, N>::LimitTerm(const ResidentInputs& inputs, const Batch& batch, const LimitPartOf<N>& part)
    : Base(inputs, "strain_limit", batch.vertices(), TermGroup::limit, Phase::strain_limit),
      options_(inputs.options),
      vertex_mass_(inputs.mass),
      launches_(launches_of<R, N>(*options_.limit.shape.launches)),
      adds_(of_solids && !inputs.scene.limit.triangles.empty()),
      vertex_(executor_, of_solids ? "solid limit vertices" : "limit vertices"),
      shapes_(executor_, of_solids ? "solid limit rest shapes" : "limit rest shapes", batch.rests()),
      band_(executor_, "limit bands"),
      mass_(executor_, "limit element masses"),
      state_(executor_, "limit stretches and barrier terms", 5 * N * static_cast<Index>(batch.size())),
      kappa_(executor_, "limit stiffness", static_cast<Index>(batch.size())),
      before_(executor_, "limit stiffness before"),
      parts_(executor_, "limit stiffness parts"),
      least_(executor_),
      beyond_(executor_),
      bounds_(executor_),
      numbers_(executor_) {
  const Index n = kappa_.size();
  vertex_.upload(to_columns(batch.vertices(), N + 1));
  upload_pair(part.onset, part.width, band_);
  if (!policy().uniform()) {
    mass_.upload(part.mass);
    before_.resize(n);
  }
  if (policy().has_potential()) parts_.resize(n);
  set_columns(n);
}

template <int R, int N>
void LimitTerm<R, N>::set_columns(Index n) {
  elements_.of = vertex_.data();
  elements_.n = n;
  elements_.rest = shapes_.rest();
  elements_.onset = band_.data(), elements_.band_width = band_.data() + n;
  double* column = state_.data();
  for (double** pointer : {&elements_.sigma, &elements_.gap, &elements_.b, &elements_.db, &elements_.d2b}) {
    *pointer = column;
    column += N * n;
  }
  elements_.kappa = kappa_.data();
}

// kappa at the iterate, as its rule has it, and its largest relative change among active elements; 0 where the rule
// keeps it.
template <int R, int N>
void LimitTerm<R, N>::refresh(const Column& x, const MatrixPart& elastic) {
  const bool first = first_, keep = fresh_ && policy().frozen_in_step();
  first_ = false, fresh_ = true;
  announced_ = false;
  const bool measured = accepted_ && measured_ == State::iterate;  // as the trial that became it
  accepted_ = false;
  if (!measured) measured_ = State::none;
  if (keep) {
    measure_iterate(x);
  } else {
    if (!measured) measure_stretch(x);
    fill_kappa(elastic);
    if (!measured || parts()) fill_barrier();
    measured_ = State::iterate;
  }
  kappa_change_ = 0;
  if (keep || first || policy().uniform() || policy().has_potential()) return;
  least_.clear();
  least_.add(size(), LimitKappaChange<N>{elements_, before_.data()});
  kappa_change_ = least_.largest();
}

template <int R, int N>
void LimitTerm<R, N>::fill_kappa(const MatrixPart& elastic) {
  const ElementKappaInputs<N> of{elements_,
                                 policy().needs_hessian(),
                                 time_,
                                 x_n_,
                                 vertex_mass_.data(),
                                 mass_.data(),
                                 elastic,
                                 parts(),
                                 before_.data()};
  const PolicyLaunches& launches = *policy().launches();
  if constexpr (of_solids) {
    launches.tetrahedra(executor_, policy(), of);
  } else {
    launches.triangles(executor_, policy(), of);
  }
}

// A second look: one element's bound may, by rounding alone, be beyond another's limit.
template <int R, int N>
void LimitTerm<R, N>::look_along(const ResidentMotion& motion, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_bound);
  bounds_.fill(0xff);
  StretchBound<R, N> look{
      elements_, motion.x0.data(),          motion.dx.data(), 1, options_.contact_options.ccd_park,
      nullptr,   &bounds_.to_write()->first};
  executor_.each(size(), look);
  look.before = &bounds_.data()->first, look.smallest = &bounds_.to_write()->second;
  executor_.each(size(), look);
}

template <int R, int N>
double LimitTerm<R, N>::bound(const ResidentMotion& motion, IterateNumbers& out, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_bound);
  const auto say = [&](double alpha) {
    out.alpha_strain = adds_ ? std::min(out.alpha_strain, alpha) : alpha;
    return alpha;
  };
  if (executor_.counts_only()) return say(1);
  const Bounds found = bounds_.get();
  if (found.first == ResidentLeast::none) return say(1);
  double alpha = exec::from_ordered_bits(found.first);
  for (Key key = found.second; key != ResidentLeast::none && alpha != 0; key = least_.get()) {
    alpha = exec::from_ordered_bits(key);
    least_.clear();
    executor_.each(size(), StretchBound<R, N>{elements_, motion.x0.data(), motion.dx.data(), alpha,
                                              options_.contact_options.ccd_park, nullptr, least_.data()});
  }
  return say(alpha);
}

template <int R, int N>
bool LimitTerm<R, N>::admits(const Column&, const Column&, PhaseClock&) {
  return options_.limit.literal || beyond_.first() < 0;
}

template <int R, int N>
void LimitTerm<R, N>::announce(const Column& x) {
  measure_iterate(x);
  numbers_.clear();
  numbers_.add(size(), LimitParts<N>{elements_});
  announced_ = true;
}

template <int R, int N>
typename LimitTerm<R, N>::Numbers LimitTerm<R, N>::numbers(const Column& x) {
  if (!announced_) announce(x);
  const LimitNumbers found = numbers_.get();
  return {largest_of(found.stretch) - 1, largest_of(found.load), smallest_of(found.gap)};
}

// Stretch and load of a state; those of triangles stay where they are said before.
template <int R, int N>
template <class Out>
void LimitTerm<R, N>::say_state(const Numbers& found, Out& out) const {
  if (adds_) {
    keep_larger(out.max_stretch, Number(found.max_stretch));
  } else {
    out.max_stretch = found.max_stretch;
  }
  (of_solids ? out.solid_limit_load_max_Pa : out.limit_load_max_N_per_m) = found.load_max;
}

template <int R, int N>
void LimitTerm<R, N>::report(const Column& x, IterateNumbers& out, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_limit);
  const Numbers found = numbers(x);
  say_state(found, out);
  if (adds_) {
    keep_larger(out.limit_kappa_change_rel, Number(kappa_change_));
    keep_smaller(out.limit_gap_min_rel, Number(found.gap_min_rel));
  } else {
    out.limit_kappa_change_rel = kappa_change_;
    out.limit_gap_min_rel = found.gap_min_rel;
  }
}

template <int R, int N>
void LimitTerm<R, N>::report_end(const Column& x, StepNumbers& out) {
  say_state(numbers(x), out);
}

template <int R, int N>
void add_limit(const ResidentInputs& inputs, std::span<const std::array<int, N + 1>> elements,
               const LimitPartOf<N>& part, ResidentTermList& terms) {
  if (elements.empty()) return;
  const StrainLimitBatchOf<LimitedRest<N>> batch(elements, inputs.scene.rest, part.onset, part.width, R == 2);
  terms.add(std::make_unique<LimitTerm<R, N>>(inputs, batch, part));
}

}  // namespace

void require_limit_kernels(const TermOptions& options) {
  if (!options.limit.shape.launches) {
    throw ConfigError("shape", options.limit.shape.name,
                      "a shape of barriers/shapes: a plugin's and another exponent have no kernel");
  }
  for (const auto* policy : {&options.limit_stiffness, &options.solid_limit_stiffness}) {
    if (!*policy || ((*policy)->launches() && (*policy)->launches()->triangles)) continue;
    throw ConfigError("stiffness_policy/name", std::string((*policy)->name()), host_policy_words);
  }
}

void make_resident_strain_limit(const ResidentInputs& inputs, ResidentTermList& terms) {
  require_limit_kernels(inputs.options);
  const Scene& scene = inputs.scene;
  if (scene.planar) {
    add_limit<2, 2>(inputs, scene.limit.triangles, scene.limit, terms);
  } else {
    add_limit<3, 2>(inputs, scene.limit.triangles, scene.limit, terms);
  }
  add_limit<3, 3>(inputs, scene.solid_limit.tetrahedra, scene.solid_limit, terms);
}

}  // namespace bb::resident
