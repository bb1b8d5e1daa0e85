#include "core/terms/linear_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/archive/archive.hpp"
#include "core/contact/row_columns.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

constexpr int most_adaptations = 10;    // of penalty and standoff, in a step
constexpr double least_advance = 1e-6;  // below it the anchor stays
constexpr double same_time = 1e-6;      // hits that come so near to each other come at once

ContactOptions without_mollifier(ContactOptions options) {
  options.mollifier = Mollifier::none;
  return options;
}

}  // namespace

LinearContact::LinearContact(const Scene& scene, const TermOptions& options, const ContactPlan& plan)
    : options_(options),
      rules_(*options.linear_contact),
      pairs_(scene, options.contact_options, plan),
      contacts_(scene, without_mollifier(options.contact_options)) {
  if (scene.collisions.chosen()) {
    throw ConfigError("/step_solver/name", "al_free with collisions that are chosen for bodies",
                      "a scene in which all bodies collide as ccd, or another step solver");
  }
  families_.resize(1);
  earliest_.assign(static_cast<std::size_t>(scene.n_vertices()), 0);
}

void LinearContact::Constraint::keep(Archive& archive) { archive(pair, force, quiet); }

void LinearContact::keep(Archive& archive) { archive(constraints_, penalty_); }

void LinearContact::adopt_from(const HostTerm& other) {
  const auto& of = static_cast<const LinearContact&>(other);
  constraints_ = of.constraints_;
  anchor_ = of.anchor_;
  x_n_ = of.x_n_;
  dt_ = of.dt_;
  penalty_ = of.penalty_;
  standoff_ = of.standoff_;
  list_stencils();
}

void LinearContact::begin_step(const StepColumns& step, PhaseClock&) {
  stalled_ = adaptations_ = 0;
  standoff_ = rules_.standoff;
  if (rules_.penalty > 0) penalty_ = rules_.penalty;
  x_n_ = step.x_n;
  dt_ = step.dt;
  for (Constraint& each : constraints_) each.most = most_asked(each.pair);
  set_anchor(step.x_n);
}

void LinearContact::set_penalty(double penalty) {
  if (!(rules_.penalty > 0)) penalty_ = penalty;
}

void LinearContact::set_anchor(const PositionsView& x) {
  anchor_ = x;
  linearise_constraints();
}

// Two surfaces that touch exactly have no normal: what held before goes on.
void LinearContact::linearise_constraints() {
  for (Constraint& each : constraints_) {
    const LinearGap now = pairs_.gap(each.pair, anchor_);
    if (now.normal.squaredNorm() > 0) {
      each.at = now;
    } else {
      each.at.d = now.d;
    }
  }
  list_stencils();
}

void LinearContact::list_stencils() {
  stencil_.resize(4 * constraints_.size());
  for (std::size_t i = 0; i < constraints_.size(); ++i)
    std::copy_n(constraints_[i].at.vertex.begin(), 4, stencil_.begin() + static_cast<std::ptrdiff_t>(4 * i));
  families_[0].stencils = {4, stencil_};
}

double LinearContact::most_asked(PairId pair) const {
  return pairs_.gap(pair, x_n_).d + rules_.recovery_speed * dt_;
}

double LinearContact::asked(const Constraint& of) const { return std::min(standoff_ * of.at.d_hat, of.most); }

double LinearContact::value(const Constraint& of, const PositionsView& x) const {
  double opening = 0;
  for (std::size_t k = 0; k < 4 && of.at.vertex[k] >= 0; ++k) {
    const int v = of.at.vertex[k];
    opening += of.at.weight[k] * of.at.normal.dot(x.col(v) - anchor_.col(v));
  }
  return of.at.d - asked(of) + opening;
}

double LinearContact::weight(const Constraint& of) const {
  return std::pow(rules_.decay, of.quiet) * penalty_;
}

void LinearContact::linearise(const PositionsView& x, const TermContext&) {
  TermFamily& family = families_[0];
  const std::size_t n = constraints_.size();
  family.local.energy.resize(n);
  family.local.grad.resize(12 * n);
  family.local.hess.resize(row_hessian_numbers * n);
  for (std::size_t i = 0; i < n; ++i) {
    Constraint& each = constraints_[i];
    const double c = value(each, x), shift = each.force / penalty_, mu = weight(each);
    each.slack = std::max(0.0, c - shift);
    const double off = c - each.slack - shift;
    Vec<double, 12> g = Vec<double, 12>::Zero();
    for (std::size_t k = 0; k < 4; ++k)
      g.segment<3>(3 * static_cast<int>(k)) = each.at.weight[k] * each.at.normal;
    family.local.energy[i] = 0.5 * mu * off * off;
    Vec<double, 12>::Map(&family.local.grad[12 * i]) = mu * off * g;
    const Mat<double, 12, 12> h = mu * g * g.transpose();
    store_lower_blocks(4, h, &family.local.hess[row_hessian_numbers * i]);
  }
}

void LinearContact::clamp(const PositionsView&) { families_[0].clamped.hess = families_[0].local.hess; }

void LinearContact::evaluate(const PositionsView& x) {
  std::vector<double>& energy = families_[0].trial_energy;
  energy.resize(constraints_.size());
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const Constraint& each = constraints_[i];
    const double off = value(each, x) - each.slack - each.force / penalty_;
    energy[i] = 0.5 * weight(each) * off * off;
  }
}

double LinearContact::update(const PositionsView& x) {
  double change = 0;
  for (Constraint& each : constraints_) {
    const double next = each.force - penalty_ * value(each, x);
    each.quiet = next > 0 ? 0 : each.quiet + 1;
    change = std::max(change, std::abs(std::max(0.0, next) - each.force) / penalty_);
    each.force = std::max(0.0, next);
  }
  return change;
}

const LinearContact::Constraint* LinearContact::find(PairId pair) const {
  const auto at = std::lower_bound(constraints_.begin(), constraints_.end(), pair,
                                   [](const Constraint& each, PairId of) { return each.pair < of; });
  return at != constraints_.end() && at->pair == pair ? &*at : nullptr;
}

LinearContact::Advance LinearContact::advance(const PositionsView& x, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::step_bound);
  Advance out;
  const std::vector<MotionHit>& hits = pairs_.hits(anchor_, x);
  out.bound = pairs_.earliest();
  out.hits = hits.size();
  const double first = take_hits(hits, out);
  renew_constraints(out);
  out.time = hits.empty() ? 1 : rules_.advance * first;
  if (out.time > least_advance) {
    anchor_ = hits.empty() ? Positions(x) : Positions(anchor_ + out.time * (x - anchor_));
  } else {
    out.time = 0;
  }
  note_stall(out.time);
  linearise_constraints();
  return out;
}

// The time of the first hit, at most 1. Fresh are hits of pairs that are no constraints.
double LinearContact::take_hits(const std::vector<MotionHit>& hits, Advance& out) {
  fresh_.clear();
  std::fill(earliest_.begin(), earliest_.end(), std::numeric_limits<double>::infinity());
  double first = 1;
  for (const MotionHit& hit : hits) {
    const bool known = find(hit.pair) != nullptr;
    if (hit.time < first) first = hit.time, out.known = known;
    if (known) continue;
    fresh_.push_back(hit);
    for (const int v : hit.vertex) {
      if (v >= 0)
        earliest_[static_cast<std::size_t>(v)] = std::min(earliest_[static_cast<std::size_t>(v)], hit.time);
    }
  }
  return first;
}

// Drops constraints whose weight is too small, and admits fresh hits that are the first for one of their vertices.
void LinearContact::renew_constraints(Advance& out) {
  merged_.clear();
  for (const Constraint& each : constraints_) {
    if (std::pow(rules_.decay, each.quiet) >= rules_.least_weight) merged_.push_back(each);
  }
  out.dropped = constraints_.size() - merged_.size();
  for (const MotionHit& hit : fresh_) {
    const bool is_first = std::any_of(hit.vertex.begin(), hit.vertex.end(), [&](int v) {
      return v >= 0 && hit.time <= earliest_[static_cast<std::size_t>(v)] + same_time;
    });
    if (!is_first) continue;
    Constraint each;
    each.pair = hit.pair;
    each.most = most_asked(hit.pair);
    merged_.push_back(each);
    ++out.admitted;
  }
  std::sort(merged_.begin(), merged_.end(),
            [](const Constraint& a, const Constraint& b) { return a.pair < b.pair; });
  constraints_.swap(merged_);
}

void LinearContact::note_stall(double time) {
  stalled_ = time < rules_.stall_time ? stalled_ + 1 : 0;
  if (stalled_ < rules_.stall_updates || adaptations_ == most_adaptations) return;
  stalled_ = 0;
  ++adaptations_;
  penalty_ *= 2;
  standoff_ /= 2;
}

double LinearContact::largest_force() const {
  double largest = 0;
  for (const Constraint& each : constraints_) largest = std::max(largest, each.force);
  return largest;
}

double LinearContact::violation() const {
  double largest = 0;
  for (const Constraint& each : constraints_) {
    if (each.force > 0) largest = std::max(largest, standoff_ * each.at.d_hat - each.at.d);
  }
  return largest;
}

double LinearContact::opening_speed() const {
  double largest = 0;
  for (const Constraint& each : constraints_) {
    if (each.force > 0) largest = std::max(largest, (each.at.d - asked(each)) / dt_);
  }
  return largest;
}

void LinearContact::report(const PositionsView&, IterateNumbers& out, PhaseClock&) {
  if (constraints_.empty()) return;
  out.kappa_min_N_per_m = out.kappa_max_N_per_m = penalty_;
  out.contact_load_max_N = largest_force();
  out.contact_curvature_max_N_per_m = penalty_;
}

template <class Table>
void LinearContact::fill_loads(Table& rows) const {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Constraint* known = find(rows.pair[r]);
    const double pushed = known ? known->force / penalty_ : 0;
    rows.kappa[r] = penalty_;
    rows.b[r] = 0.5 * pushed * pushed;
    rows.db[r] = -pushed;
    rows.d2b[r] = pushed > 0 ? 1 : 0;
  }
}

void LinearContact::report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::output);
  contacts_.update_candidates(x, x);
  end_.gap_min = contacts_.find_rows(x, end_.rows, end_.mollified);
  fill_loads(end_.rows);
  fill_loads(end_.mollified);
  report_end_of(end_, options_.precision, x, out);
}

}  // namespace bb
