// What a sum of terms does whichever matrix engine it has.
#include "core/newton/incremental_potential.hpp"

#include <algorithm>

#include "core/base/archive/archive.hpp"

namespace bb {

void IncrementalPotential::begin_step(const StepColumns& step) {
  energies_known_ = trial_evaluated_ = announced_ = false;
  solver_begins_step();
  for (Term* term : terms_) term->begin_step(step, clock_);
}

void IncrementalPotential::change_step(const StepColumns& step) {
  energies_known_ = announced_ = false;
  for (Term* term : terms_) term->change_step(step);
}

bool IncrementalPotential::take_secant(double share) {
  bool taken = false;
  for (Term* term : terms_) taken = term->take_secant(share) || taken;
  return taken;
}

bool IncrementalPotential::renew_lagged_state(const Column& x) {
  const bool renewed =
      std::any_of(terms_.begin(), terms_.end(), [&x](Term* term) { return term->renew_lagged_state(x); });
  energies_known_ = energies_known_ && !renewed;
  announced_ = announced_ && !renewed;
  return renewed;
}

void IncrementalPotential::end_step(const Column& x) {
  for (Term* term : terms_) term->end_step(x, clock_);
}

void IncrementalPotential::keep(Archive& archive) {
  for (Term* term : terms_) {
    archive.section(term->name());
    term->keep(archive);
  }
}

void IncrementalPotential::linearise(const Column& x, Column& g) {
  for (Term* term : terms_) term->begin_iterate(x);
  linearise_terms(x, g);
  energies_known_ = true;
  announced_ = false;
}

void IncrementalPotential::add_given_motion(const Column& x, const Column& motion, Column& force) {
  for (Term* term : terms_) term->add_given_motion(x, motion, force);
}

void IncrementalPotential::prepare(const Column& x0, const Column& x1, const Column& dx, bool to_bound) {
  for (Term* term : terms_) term->prepare({x0, x1, dx, to_bound}, clock_);
}

bool IncrementalPotential::bounds_each_vertex() const {
  return std::any_of(terms_.begin(), terms_.end(),
                     [this](const Term* term) { return bounds_each_vertex_of(*term); });
}

// truncated: bounds that terms gave for each vertex the motion respects already.
double IncrementalPotential::smallest_bound(const Motion& motion, IterationReport& report, bool truncated) {
  const auto asks = [&](const Term* term) { return !truncated || !bounds_each_vertex_of(*term); };
  double smallest = 1;
  holder_ = nullptr;
  for (Term* term : terms_) {
    if (asks(term)) term->look_along(motion, clock_);
  }
  for (Term* term : terms_) {
    if (!asks(term)) continue;
    const double said = term->bound(motion, report, clock_);
    const double alpha = said >= 0 ? said : 0;  // a bound that is not a number proves nothing
    if (!(alpha < 1) || alpha > smallest) continue;
    smallest = alpha;
    holder_ = term;
  }
  return smallest;
}

void IncrementalPotential::bound_audited(bool bound) {
  for (Term* term : terms_) term->bound_audited(bound);
}

StepBound IncrementalPotential::prove_step(const Column& x_n, const Column& x) {
  StepBound smallest;
  long long queries = 0, probes = 0;
  for (Term* term : terms_) {
    const StepBound said = term->prove_step(x_n, x, clock_);
    queries += said.queries, probes += said.probes;
    if (!(said.alpha >= smallest.alpha)) smallest = said;  // a bound that is not a number proves nothing
  }
  smallest.queries = queries, smallest.probes = probes;
  return smallest;
}

bool IncrementalPotential::curvature_correction(const Column& x, const Column& dx, double bound,
                                                Column& force) {
  force.fill_zero();
  bool held = false;
  for (Term* term : terms_) held = term->add_curvature_correction(x, dx, bound, force) || held;
  if (held) room_was_made(x);
  return held;
}

bool IncrementalPotential::is_feasible(const Column& x, Column& trial) {
  trial_evaluated_ = false;
  const bool seen =
      std::any_of(terms_.begin(), terms_.end(), [](const Term* term) { return term->sees_non_finite(); });
  if (!is_finite(trial, seen)) return false;
  for (Term* term : terms_) term->look_at(x, trial, clock_);
  for (Term* term : terms_) {
    if (!term->is_feasible(trial, clock_)) return false;
  }
  for (Term* term : terms_) term->freeze(clock_);
  return true;
}

EnergyChange IncrementalPotential::change(const Column& x, const Column& trial) {
  know_energies(x);
  for (Term* term : terms_) term->evaluate(trial);
  trial_evaluated_ = true;
  return sum_change(x, trial);
}

void IncrementalPotential::accept() {
  for (Term* term : terms_) {
    term->accept(clock_);
    if (trial_evaluated_) term->take_energies();
  }
  energies_known_ = trial_evaluated_;
  trial_evaluated_ = announced_ = false;
}

// A step that compares no energies ends with a state that has none, which the record needs.
void IncrementalPotential::know_energies(const Column& x) {
  if (energies_known_) return;
  const WholePhase timer(clock_, Phase::output);
  for (Term* term : terms_) term->evaluate_iterate(x);
  energies_known_ = true;
}

void IncrementalPotential::announce(const Column& x) {
  if (!launches()) return;
  know_energies(x);
  announce_energy(x);
  announced_ = true;
  for (Term* term : terms_) term->announce(x);
}

double IncrementalPotential::energy(TermSet set, const Column& x) {
  know_energies(x);
  return sum_energy(set, x, announced_ && set == TermSet::all());
}

void IncrementalPotential::report(const Column& x, IterateNumbers& out) {
  for (Term* term : terms_) term->report(x, out, clock_);
}

void IncrementalPotential::report_end(const Column& x, StepNumbers& out) {
  know_energies(x);
  for (Term* term : terms_) term->report_end(x, out, clock_);
}

}  // namespace bb
