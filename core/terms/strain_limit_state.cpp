#include "core/terms/strain_limit_state.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/barrier/folded_barrier.hpp"
#include "core/barrier/launches.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

std::unique_ptr<LimitFamily> limited(const FamilyPlace& place, const Scene& scene, bool of_solids) {
  if (of_solids) return limited_tetrahedra(place, scene.solid_limit, scene.rest);
  return limited_triangles(place, scene.limit, scene.rest, scene.planar);
}

// Stretch and load of a state; those of triangles stay where they were reported before.
template <class Numbers>
void say_state(const StrainLimitState& of, const LimitReport& found, Numbers& out) {
  if (of.adds()) {
    keep_larger(out.max_stretch, Number(found.max_stretch));
  } else {
    out.max_stretch = found.max_stretch;
  }
  (of.of_solids() ? out.solid_limit_load_max_Pa : out.limit_load_max_N_per_m) = found.load_max;
}

}  // namespace

StrainLimitState::StrainLimitState(exec::Executor& executor, const Scene& scene, const TermOptions& options,
                                   bool of_solids, const double* vertex_mass)
    : options_(options),
      of_solids_(of_solids),
      adds_(of_solids && !scene.limit.triangles.empty()),
      vertex_mass_(vertex_mass),
      family_(limited({executor, options.precision}, scene, of_solids)),
      beyond_(executor) {
  if (!policy().launches() || !policy().launches()->triangles) {
    throw ConfigError("stiffness_policy/name", std::string(policy().name()),
                      "a policy that serves a strain limit");
  }
  if (policy().has_potential() && !has_potential(options.limit)) {
    throw std::logic_error("no potential: " + options.limit.shape.name);
  }
}

void StrainLimitState::begin_step(const double* x_n, const StiffnessTime& time) {
  fresh_ = false, first_ = true;
  announced_ = accepted_ = looked_at_ = false;
  measured_ = State::none;
  x_n_ = x_n;
  time_ = time;
}

// kappa of a rule that keeps it is that of the first iterate of the step. What was measured of a trial is not measured again where it is
// the iterate; any other state may be handed over, so it is. Where kappa is folded into the barrier terms these are made anew with it.
void StrainLimitState::refresh(const double* x, const ElasticMatrix& elastic, double* energy) {
  const bool first = first_, keep = keeps_kappa();
  const bool measured = accepted_ && measured_ == State::iterate;
  first_ = false, fresh_ = true;
  announced_ = accepted_ = false;
  kappa_change_ = 0;
  if (!measured) measured_ = State::none;
  if (keep) return measure_iterate(x, energy);
  if (!measured) family_->measure(x);
  family_->make_kappa(policy(), {time_, x_n_, vertex_mass_, elastic});
  if (!measured || policy().has_potential()) family_->fill_barrier(options_.limit);
  measured_ = State::iterate;
  if (first || policy().uniform() || policy().has_potential()) return;
  kappa_change_ = family_->kappa_change();
}

void StrainLimitState::measure_iterate(const double* x, double* energy) {
  if (measured_ != State::iterate) measure(x, energy, State::iterate);
}

// With the kappa that there is.
void StrainLimitState::measure(const double* x, double* energy, State state) {
  beyond_.clear();
  family_->measure(x, options_.limit, energy, beyond_.data());
  measured_ = state;
  announced_ = false;
}

void StrainLimitState::look_along(const double* x, const double* dx) {
  family_->look_along(x, dx, options_.contact_options.min_gap_fraction);
}

double StrainLimitState::bound(IterateNumbers& out) {
  const double alpha = family_->bound();
  out.alpha_strain = adds_ ? std::min(out.alpha_strain, alpha) : alpha;
  return alpha;
}

void StrainLimitState::look_at(const double* trial, double* energy) {
  measure(trial, energy, State::trial);
  looked_at_ = true;
}

bool StrainLimitState::is_feasible() const { return options_.limit.literal || beyond_.first() < 0; }

void StrainLimitState::evaluate(const double* trial, double* energy) {
  // the iterate may have been requested since
  if (!looked_at_ || measured_ != State::trial) measure(trial, energy, State::trial);
  looked_at_ = false;
}

void StrainLimitState::accept() {
  announced_ = looked_at_ = false;
  accepted_ = measured_ == State::trial;
  measured_ = accepted_ ? State::iterate : State::none;
}

void StrainLimitState::announce(const double* x, double* energy) {
  measure_iterate(x, energy);
  family_->announce();
  announced_ = true;
}

LimitReport StrainLimitState::numbers(const double* x, double* energy) {
  if (!announced_) announce(x, energy);
  return family_->report();
}

void StrainLimitState::report(const double* x, double* energy, IterateNumbers& out) {
  const LimitReport found = numbers(x, energy);
  say_state(*this, found, out);
  if (adds_) {
    keep_larger(out.limit_kappa_change_rel, Number(kappa_change_));
    keep_smaller(out.limit_gap_min_rel, Number(found.gap_min_rel));
  } else {
    out.limit_kappa_change_rel = kappa_change_;
    out.limit_gap_min_rel = found.gap_min_rel;
  }
}

void StrainLimitState::report_end(const double* x, double* energy, StepNumbers& out) {
  say_state(*this, numbers(x, energy), out);
}

}  // namespace bb
