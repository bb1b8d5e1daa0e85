#include "core/terms/strain_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/barrier/relative_change.hpp"
#include "core/math/parallel.hpp"
#include "core/terms/barrier_load.hpp"
#include "core/terms/registry.hpp"

namespace bb {

StrainLimitTerm::StrainLimitTerm(const Scene& scene, const TermOptions& options,
                                 const std::vector<std::uint8_t>& fixed)
    : scene_(scene),
      options_(options),
      fixed_(fixed),
      batch_(scene.limit.triangles, scene.rest, scene.limit.onset, scene.limit.width, scene.planar,
             options.precision),
      kappa_(batch_.size()) {
  if (options.limit_stiffness->has_potential()) {
    folded_.emplace(Folded{FoldedBarrier(options.limit), std::vector<KappaParts>(2 * batch_.size())});
  }
  TermFamily& family = families_.emplace_back();
  family.stencils = {3, batch_.vertices()};
  family.local.resize(batch_.size(), 3);
  family.trial_energy.resize(batch_.size());
}

void StrainLimitTerm::begin_step(const StepFrame& frame, PhaseClock&) {
  x_n_ = frame.x_n;
  change_frame(frame);
  kappa_fresh_ = false;
  first_iterate_ = true;
}

void StrainLimitTerm::change_frame(const StepFrame& frame) { time_ = {frame.dt, frame.c}; }

void StrainLimitTerm::linearise(const PositionsView& x, const TermContext& context) {
  kappa_change_ = 0;
  refresh_stiffness(x, context);
  first_iterate_ = false;
  fill(x, context.projection, families_[0].local);
}

void StrainLimitTerm::clamp(const PositionsView& x) { fill(x, Projection::psd, families_[0].clamped); }

void StrainLimitTerm::fill(const PositionsView& x, Projection projection, LocalTerms& out) {
  if (folded_) {
    batch_.derivatives(x, *folded_, kappa_.data(), projection, out);
  } else {
    batch_.derivatives(x, options_.limit, kappa_.data(), projection, out);
  }
}

void StrainLimitTerm::refresh_stiffness(const PositionsView& x, const TermContext& context) {
  const StiffnessPolicy& policy = *options_.limit_stiffness;
  if (kappa_fresh_ && policy.frozen_in_step()) return;
  kappa_fresh_ = true;
  kappa_before_ = kappa_;
  fill_sums(context, policy.needs_hessian());
  ElementStiffnessBatch batch{batch_.size(), sums_.data(), nullptr, scene_.limit.width.data(), time_};
  if (folded_) {
    parts_.resize(batch_.size());
    policy.fill_element_parts(batch, parts_.data());
    return fold();
  }
  batch_.measure(x);
  smaller_gaps_.resize(batch_.size());
  for (std::size_t e = 0; e < batch_.size(); ++e) smaller_gaps_[e] = smaller_gap(e);
  batch.gap = smaller_gaps_.data();
  policy.fill_elements(batch, kappa_.data());
  kappa_change_ = first_iterate_ || policy.uniform() ? 0 : stiffness_change();
}

// What the policy reads of every element.
void StrainLimitTerm::fill_sums(const TermContext& context, bool with_hessian) {
  hess_.resize(with_hessian ? 81 * batch_.size() : 0);
  parallel_items(with_hessian ? batch_.size() : 0, 64, [&](std::size_t e) {
    Mat<double, 12, 12> block;
    context.blocks.submatrix(context.elastic, &batch_.vertices()[3 * e], 3, block.data());
    Eigen::Map<Mat<double, 9, 9>> target(&hess_[81 * e]);
    target = block.topLeftCorner<9, 9>();
  });
  sums_.resize(batch_.size());
  batch_.stiffness_sums(x_n_, with_hessian ? hess_.data() : nullptr, scene_.mass.data(),
                        scene_.limit.mass.data(), sums_.data());
}

void StrainLimitTerm::fold() {
  folded_->parts.clear();
  for (const KappaParts& one : parts_) folded_->parts.insert(folded_->parts.end(), 2, one);
  std::fill(kappa_.begin(), kappa_.end(), 1.0);
}

double StrainLimitTerm::smaller_gap(std::size_t e) const {
  return std::min(batch_.gaps()[2 * e], batch_.gaps()[2 * e + 1]);
}

// Largest relative change of an active element's kappa.
double StrainLimitTerm::stiffness_change() const {
  double change = 0;
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    if (!(smaller_gap(e) < scene_.limit.width[e])) continue;
    change = std::max(change, relative_change(kappa_before_[e], kappa_[e]));
  }
  return change;
}

double StrainLimitTerm::bound(const Motion& motion, IterateNumbers& report, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_bound);
  report.alpha_strain = batch_.step_bound(motion.x0, motion.dx, 1.0, options_.contact_options.ccd_park);
  return report.alpha_strain;
}

bool StrainLimitTerm::admits(const PositionsView& x, PhaseClock&) {
  batch_.measure(x);
  return options_.limit.literal || batch_.min_gap() > 0;
}

void StrainLimitTerm::evaluate(const PositionsView& x) {
  std::vector<double>& energy = families_[0].trial_energy;
  if (folded_) {
    batch_.values(x, *folded_, kappa_.data(), energy.data());
  } else {
    batch_.values(x, options_.limit, kappa_.data(), energy.data());
  }
}

// |dS_e/dsigma| at a pseudo-gap, J.
double StrainLimitTerm::force(std::size_t e, double gap) const {
  const double kappa = folded_ ? folded_->parts[2 * e].at(gap) : kappa_[e];
  return -kappa * options_.limit.eval(gap, scene_.limit.width[e]).db;
}

double StrainLimitTerm::load_max() const {
  double largest = 0;
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    const double width = scene_.limit.width[e];
    for (const double gap : batch_.gaps().subspan(2 * e, 2)) {
      if (gap >= width) continue;
      largest = std::max(largest, force(e, gap) / batch_.rests()[e].area);
    }
  }
  return largest;
}

void StrainLimitTerm::report(const PositionsView& x, IterateNumbers& out, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_limit);
  batch_.measure(x);
  out.max_stretch = batch_.max_stretch();
  out.limit_load_max_N_per_m = load_max();
  out.limit_kappa_change_rel = kappa_change_;
  double gap = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    gap = std::min(gap, smaller_gap(e) / scene_.limit.width[e]);
  }
  out.limit_gap_min_rel = gap;
}

void StrainLimitTerm::report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::strain_limit);
  batch_.measure(x);
  out.max_stretch = batch_.max_stretch();
  out.limit_load_max_N_per_m = load_max();
}

// Of element e on its own: how many times larger its force would have to be to balance the rest along itself.
double StrainLimitTerm::times_larger(std::size_t e, const PositionsView& others) const {
  const std::vector<double>& gradient = families_[0].local.grad;
  double needed = 0, own = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(batch_.vertices()[3 * e + k]);
    for (std::size_t c = 0; c < 3; ++c) {
      if (fixed_[3 * v + c]) continue;  // carried by the pin
      const double g = gradient[9 * e + 3 * k + c];
      needed -= g * others.data()[3 * v + c];
      own += g * g;
    }
  }
  return own > std::numeric_limits<double>::min() ? needed / own : 0;
}

std::string StrainLimitTerm::element_name(std::size_t e) const {
  const int first = batch_.vertices()[3 * e];
  const Body& body = scene_.bodies[static_cast<std::size_t>(scene_.body[static_cast<std::size_t>(first)])];
  return fmt::format("triangle {}[{} {} {}]", body.name, first - body.first_vertex,
                     batch_.vertices()[3 * e + 1] - body.first_vertex,
                     batch_.vertices()[3 * e + 2] - body.first_vertex);
}

// The larger of two estimates: what everything but the limit puts on an element on its own, and the force at
// which the Newton model would come to rest.
void StrainLimitTerm::report_overload(const PositionsView& x, const PositionsView& others,
                                      const PositionsView& dx, StepNumbers& out) {
  out.limit_overload = 0;
  if (options_.limit.shape.infinite_at_zero || folded_) return;
  batch_.measure(x);
  const std::vector<double> gaps(batch_.gaps().begin(), batch_.gaps().end());
  batch_.measure(Positions(x + dx));
  LargestSlope slope(options_.limit);
  double largest = 0;
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    const double width = scene_.limit.width[e], gap = std::min(gaps[2 * e], gaps[2 * e + 1]);
    if (!(gap < width)) continue;
    const double capacity = slope(width);
    const double share = -options_.limit.eval(gap, width).db / capacity;
    const double times = std::max(share * times_larger(e, others),
                                  newton_force(options_.limit, gap, smaller_gap(e), width) / capacity);
    if (!(times > largest)) continue;
    largest = times;
    out.limit_overload_at = element_name(e);
  }
  batch_.measure(x);
  out.limit_overload = largest;
}

PlanItem needs_strain_limit(const TermNeeds& needs) {
  const std::size_t n = needs.scene.limit.triangles.size();
  return plan_item(needs.options.strain_limit && n > 0, fmt::format("{} limited triangles", n),
                   needs.options.strain_limit ? "no limited triangle" : "strain_limit is not enabled");
}

void make_strain_limit(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<StrainLimitTerm>(inputs.scene, inputs.options, inputs.fixed));
}

}  // namespace bb
