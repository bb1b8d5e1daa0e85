#include "core/terms/strain_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/barrier/relative_change.hpp"
#include "core/math/parallel.hpp"
#include "core/terms/barrier_load.hpp"
#include "core/terms/registry.hpp"

namespace bb {

template <class Batch>
StrainLimitTermOf<Batch>::StrainLimitTermOf(const Scene& scene, const TermOptions& options,
                                            const std::vector<std::uint8_t>& fixed)
    : scene_(scene),
      options_(options),
      fixed_(fixed),
      batch_(limited_elements(part()), scene.rest, part().onset, part().width, scene.planar,
             options.precision),
      kappa_(batch_.size()) {
  if (policy().has_potential()) {
    folded_.emplace(Folded{FoldedBarrier(options.limit), std::vector<KappaParts>(Batch::N * batch_.size())});
  }
  TermFamily& family = families_.emplace_back();
  family.stencils = {batch_.width(), batch_.vertices()};
  family.local.resize(batch_.size(), batch_.width());
  family.trial_energy.resize(batch_.size());
}

template <class Batch>
void StrainLimitTermOf<Batch>::begin_step(const StepFrame& frame, PhaseClock&) {
  x_n_ = frame.x_n;
  change_frame(frame);
  kappa_fresh_ = false;
  first_iterate_ = true;
}

template <class Batch>
void StrainLimitTermOf<Batch>::change_frame(const StepFrame& frame) {
  time_ = {frame.dt, frame.c};
}

template <class Batch>
void StrainLimitTermOf<Batch>::linearise(const PositionsView& x, const TermContext& context) {
  kappa_change_ = 0;
  refresh_stiffness(x, context);
  first_iterate_ = false;
  fill(x, context.projection, families_[0].local);
}

template <class Batch>
void StrainLimitTermOf<Batch>::clamp(const PositionsView& x) {
  fill(x, Projection::psd, families_[0].clamped);
}

template <class Batch>
void StrainLimitTermOf<Batch>::fill(const PositionsView& x, Projection projection, LocalTerms& out) {
  if (folded_) {
    batch_.derivatives(x, *folded_, kappa_.data(), projection, out);
  } else {
    batch_.derivatives(x, options_.limit, kappa_.data(), projection, out);
  }
}

template <class Batch>
void StrainLimitTermOf<Batch>::refresh_stiffness(const PositionsView& x, const TermContext& context) {
  const StiffnessPolicy& policy = this->policy();
  if (kappa_fresh_ && policy.frozen_in_step()) return;
  kappa_fresh_ = true;
  kappa_before_ = kappa_;
  fill_sums(context, policy.needs_hessian());
  ElementStiffnessBatch batch{batch_.size(), sums_.data(), nullptr, part().width.data(), time_};
  if (folded_) {
    parts_.resize(batch_.size());
    policy.fill_element_parts(batch, parts_.data());
    return fold();
  }
  batch_.measure(x);
  smallest_gaps_.resize(batch_.size());
  for (std::size_t e = 0; e < batch_.size(); ++e) smallest_gaps_[e] = smallest_gap(e);
  batch.gap = smallest_gaps_.data();
  policy.fill_elements(batch, kappa_.data());
  kappa_change_ = first_iterate_ || policy.uniform() ? 0 : stiffness_change();
}

// What the policy reads of every element.
template <class Batch>
void StrainLimitTermOf<Batch>::fill_sums(const TermContext& context, bool with_hessian) {
  constexpr int size = 3 * Batch::n_points;
  constexpr auto numbers = static_cast<std::size_t>(size * size);
  hess_.resize(with_hessian ? numbers * batch_.size() : 0);
  parallel_items(with_hessian ? batch_.size() : 0, 64, [&](std::size_t e) {
    Mat<double, 12, 12> block;
    context.blocks.submatrix(context.elastic, &batch_.vertices()[Batch::P * e], Batch::n_points,
                             block.data());
    Eigen::Map<Mat<double, size, size>> target(&hess_[numbers * e]);
    target = block.topLeftCorner<size, size>();
  });
  sums_.resize(batch_.size());
  batch_.stiffness_sums(x_n_, with_hessian ? hess_.data() : nullptr, scene_.mass.data(), part().mass.data(),
                        sums_.data());
}

template <class Batch>
void StrainLimitTermOf<Batch>::fold() {
  folded_->parts.clear();
  for (const KappaParts& one : parts_) folded_->parts.insert(folded_->parts.end(), Batch::N, one);
  std::fill(kappa_.begin(), kappa_.end(), 1.0);
}

// Largest relative change of an active element's kappa.
template <class Batch>
double StrainLimitTermOf<Batch>::stiffness_change() const {
  double change = 0;
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    if (!(smallest_gap(e) < part().width[e])) continue;
    change = std::max(change, relative_change(kappa_before_[e], kappa_[e]));
  }
  return change;
}

template <class Batch>
double StrainLimitTermOf<Batch>::bound(const Motion& motion, IterateNumbers& report, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_bound);
  const double alpha = batch_.step_bound(motion.x0, motion.dx, 1.0, options_.contact_options.ccd_park);
  report.alpha_strain = adds() ? std::min(report.alpha_strain, alpha) : alpha;
  return alpha;
}

template <class Batch>
bool StrainLimitTermOf<Batch>::admits(const PositionsView& x, PhaseClock&) {
  batch_.measure(x);
  return options_.limit.literal || batch_.min_gap() > 0;
}

template <class Batch>
void StrainLimitTermOf<Batch>::evaluate(const PositionsView& x) {
  std::vector<double>& energy = families_[0].trial_energy;
  if (folded_) {
    batch_.values(x, *folded_, kappa_.data(), energy.data());
  } else {
    batch_.values(x, options_.limit, kappa_.data(), energy.data());
  }
}

// |dS_e/dsigma| at a pseudo-gap, J.
template <class Batch>
double StrainLimitTermOf<Batch>::force(std::size_t e, double gap) const {
  const double kappa = folded_ ? folded_->parts[Batch::N * e].at(gap) : kappa_[e];
  return -kappa * options_.limit.eval(gap, part().width[e]).db;
}

template <class Batch>
double StrainLimitTermOf<Batch>::load_max() const {
  double largest = 0;
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    const double width = part().width[e];
    for (const double gap : batch_.gaps().subspan(Batch::N * e, Batch::N)) {
      if (gap >= width) continue;
      largest = std::max(largest, force(e, gap) / batch_.measure_of(e));
    }
  }
  return largest;
}

// Stretch and load of the measured state; those of triangles stay where they are said before.
template <class Batch>
template <class Numbers>
void StrainLimitTermOf<Batch>::say_state(Numbers& out) const {
  const Number stretch = batch_.max_stretch();
  if (adds()) {
    keep_larger(out.max_stretch, stretch);
  } else {
    out.max_stretch = stretch;
  }
  (of_solids ? out.solid_limit_load_max_Pa : out.limit_load_max_N_per_m) = load_max();
}

template <class Batch>
void StrainLimitTermOf<Batch>::report(const PositionsView& x, IterateNumbers& out, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_limit);
  batch_.measure(x);
  say_state(out);
  double gap = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    gap = std::min(gap, smallest_gap(e) / part().width[e]);
  }
  if (adds()) {
    keep_larger(out.limit_kappa_change_rel, Number(kappa_change_));
    keep_smaller(out.limit_gap_min_rel, Number(gap));
  } else {
    out.limit_kappa_change_rel = kappa_change_;
    out.limit_gap_min_rel = gap;
  }
}

template <class Batch>
void StrainLimitTermOf<Batch>::report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_limit);
  batch_.measure(x);
  say_state(out);
}

// Of element e on its own: how many times larger its force would have to be to balance the rest along itself.
template <class Batch>
double StrainLimitTermOf<Batch>::times_larger(std::size_t e, const PositionsView& others) const {
  const std::vector<double>& gradient = families_[0].local.grad;
  double needed = 0, own = 0;
  for (std::size_t k = 0; k < Batch::P; ++k) {
    const auto v = static_cast<std::size_t>(batch_.vertices()[Batch::P * e + k]);
    for (std::size_t c = 0; c < 3; ++c) {
      if (fixed_[3 * v + c]) continue;  // carried by the pin
      const double g = gradient[3 * (Batch::P * e + k) + c];
      needed -= g * others.data()[3 * v + c];
      own += g * g;
    }
  }
  return own > std::numeric_limits<double>::min() ? needed / own : 0;
}

template <class Batch>
std::string StrainLimitTermOf<Batch>::element_name(std::size_t e) const {
  const std::span<const int> vertices = batch_.vertices().subspan(Batch::P * e, Batch::P);
  const Body& body =
      scene_.bodies[static_cast<std::size_t>(scene_.body[static_cast<std::size_t>(vertices[0])])];
  std::string numbers;
  for (const int v : vertices)
    numbers += fmt::format("{}{}", numbers.empty() ? "" : " ", v - body.first_vertex);
  return fmt::format("{} {}[{}]", of_solids ? "tetrahedron" : "triangle", body.name, numbers);
}

// The larger of two estimates: what everything but the limit puts on an element on its own, and the force at
// which the Newton model would come to rest.
template <class Batch>
void StrainLimitTermOf<Batch>::report_overload(const PositionsView& x, const PositionsView& others,
                                               const PositionsView& dx, StepNumbers& out) {
  if (!adds()) out.limit_overload = 0;
  if (options_.limit.shape.infinite_at_zero || folded_) return;
  batch_.measure(x);
  const std::vector<double> gaps(batch_.gaps().begin(), batch_.gaps().end());
  batch_.measure(Positions(x + dx));
  LargestSlope slope(options_.limit);
  double largest = adds() ? out.limit_overload.value : 0;
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    const double width = part().width[e],
                 gap = *std::min_element(&gaps[Batch::N * e], &gaps[Batch::N * e] + Batch::N);
    if (!(gap < width)) continue;
    const double capacity = slope(width);
    const double share = -options_.limit.eval(gap, width).db / capacity;
    const double times = std::max(share * times_larger(e, others),
                                  newton_force(options_.limit, gap, smallest_gap(e), width) / capacity);
    if (!(times > largest)) continue;
    largest = times;
    out.limit_overload_at = element_name(e);
  }
  batch_.measure(x);
  out.limit_overload = largest;
}

template class StrainLimitTermOf<StrainLimitBatch>;
template class StrainLimitTermOf<SolidLimitBatch>;

PlanItem needs_strain_limit(const TermNeeds& needs) {
  const std::size_t n = needs.scene.limit.triangles.size(), m = needs.scene.solid_limit.tetrahedra.size();
  std::string found = fmt::format("{} limited triangles", n);
  if (m > 0) found = (n > 0 ? found + ", " : "") + fmt::format("{} limited tetrahedra", m);
  return plan_item(needs.options.strain_limit && n + m > 0, found,
                   needs.options.strain_limit ? "no limited triangle" : "strain_limit is not enabled");
}

void make_strain_limit(const TermInputs& inputs, TermList& terms) {
  if (!inputs.scene.limit.triangles.empty()) {
    terms.add(std::make_unique<StrainLimitTerm>(inputs.scene, inputs.options, inputs.fixed));
  }
  if (!inputs.scene.solid_limit.tetrahedra.empty()) {
    terms.add(std::make_unique<SolidLimitTerm>(inputs.scene, inputs.options, inputs.fixed));
  }
}

}  // namespace bb
