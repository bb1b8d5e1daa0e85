// The contact term from iterate to iterate. Its stiffness policy is in contact_policy.cpp, what it reports of
// itself in contact_report.cpp.
#include "core/terms/contact.hpp"

#include <utility>

#include "core/contact/contact_forces.hpp"
#include "core/contact/contact_loads.hpp"
#include "core/contact/pair_name.hpp"
#include "core/math/error.hpp"
#include "core/terms/linear_contact.hpp"
#include "core/terms/registry.hpp"

namespace bb {

namespace {

ContactOptions contact_options(const TermOptions& options) {
  ContactOptions out = options.contact_options;
  out.precision = options.precision;
  return out;
}

}  // namespace

ContactTerm::ContactTerm(const TermInputs& inputs, const TermList& terms)
    : ContactSteps(inputs.scene, inputs.options),
      fixed_(inputs.fixed),
      terms_(terms),
      contacts_(scene_, contact_options(options_), inputs.contacts),
      stiffness_(inputs.executor, *options_.stiffness, scene_.mass) {
  const Scene& scene = scene_;
  const TermOptions& options = options_;
  const PairAreas* areas = contacts_.areas();
  if (areas && areas->without_area() >= 0) {
    throw ConfigError(
        "/contact/weighting", contacts_.corrected() ? "\"area_corrected\"" : "\"area\"",
        "none: " + pair_name(scene, {areas->without_area(), -1, -1, -1}, ContactKind::point_point) +
            " belongs to no triangle and has no area");
  }
  if (scene.planar && options.contact_options.model != ContactModel::all_pairs)
    throw ConfigError("/contact/model", "another one than all_pairs", "all_pairs: the scene is planar");
  families_.resize(2);
  if (const GapStiffness* of = options.stiffness->gap_stiffness()) {
    gap_potential_.emplace(options.contact, *of);
  } else if (options.stiffness->has_potential()) {
    folded_.emplace(options.contact);
  }
  if (options.multipliers) multipliers_.emplace(*options.multipliers);
  if (options.barrier_multipliers) beside_.emplace(*options.barrier_multipliers);
  use_state();
}

namespace {

// kappa b is the energy then, kappa b' and kappa b'' its derivatives.
template <class Potential, class Table>
void fill_folded(Potential& barrier, Table& rows) {
  barrier.eval(rows.size(), rows.d.data(), rows.d_hat.data(), rows.parts.data(), rows.b.data(),
               rows.db.data(), rows.d2b.data());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!(rows.kappa[r] > 0)) continue;  // without stiffness all three are 0
    for (auto* column : {&rows.b, &rows.db, &rows.d2b}) (*column)[r] /= rows.kappa[r];
  }
}

}  // namespace

// Local terms are on the compact free slots of either table.
void ContactTerm::use_state() {
  families_[0].stencils = {4, state_.rows.vertex};
  families_[1].stencils = {4, state_.mollified.free_vertex};
}

void ContactTerm::begin_step(const StepColumns& step, PhaseClock& clock) {
  stiffness_.begin_step();
  if (multipliers_) multipliers_->begin_step();
  if (beside_) beside_->begin_step();
  change_step(step);
  first_iterate_ = true;
  carries_ = has_multipliers();
  {
    const ScopedPhase timer(clock, Phase::broad_phase);
    contacts_.update_candidates(step.x_n, step.x_n);
  }
  const ScopedPhase timer(clock, Phase::contact_rows);
  state_.gap_min = contacts_.find_rows(step.x_n, state_.rows, state_.mollified);
  use_state();
}

void ContactTerm::change_step(const StepColumns& step) {
  ContactSteps::change_step(step);
  stiffness_.set_time(time_);
}

void ContactTerm::linearise(const PositionsView& x, const TermContext& context) {
  {
    const ScopedPhase timer(context.clock, Phase::stiffness);
    start_policy(x, context.gradient, state_.size());
    kappa_change_ = stiffness_.refresh(state_.tables(), pattern(), elastic_values());
    if (std::exchange(first_iterate_, false)) scale_multipliers();
  }
  fill_local(x, context.projection);
  contact_energies(state_.rows, families_[0].local.energy, options_.precision);
  mollified_energies(state_.mollified, x, families_[1].local.energy, options_.precision);
}

void ContactTerm::fill_shape(ContactState& state) {
  const auto fill = [this](auto& rows) {
    if (multipliers_) return multipliers_->fill(rows);
    if (folded_) {
      fill_folded(*folded_, rows);
    } else if (gap_potential_) {
      fill_folded(*gap_potential_, rows);
    } else {
      options_.contact.eval(rows.size(), rows.d.data(), rows.d_hat.data(), rows.b.data(), rows.db.data(),
                            rows.d2b.data());
    }
    if (beside_) beside_->add(rows);
  };
  fill(state.rows);
  fill(state.mollified);
}

// Of inertia and elasticity at the start of a step.
void ContactTerm::scale_multipliers() {
  if (!multipliers_) return;
  double energy = 0;
  for (const auto& term : terms_) {
    if (term->name() != "inertia" && term->group() != TermGroup::elastic) continue;
    for (const TermFamily& family : term->families())
      for (const double of : family.local.energy) energy += of;
  }
  multipliers_->set_scale(energy);
}

bool ContactTerm::renew_lagged_state(const PositionsView&) {
  carries_ = false;
  return multipliers_ && multipliers_->update(state_.rows, state_.mollified);
}

// The rows of a state that was tried without energies have none of their shape.
bool ContactTerm::update_beside() {
  fill_shape(state_);
  return beside_->update(state_.rows, state_.mollified);
}

// Gradients and Hessians of the current rows, from the kappa that they have.
void ContactTerm::fill_local(const PositionsView& x, Projection projection) {
  fill_shape(state_);
  LocalTerms &local = families_[0].local, &mollified = families_[1].local;
  contact_terms(state_.rows, x, options_.hessian_mode, projection, local.grad, local.hess,
                options_.precision);
  mollified_terms(state_.mollified, x, projection, mollified.grad, mollified.hess, options_.precision);
}

void ContactTerm::clamp(const PositionsView& x) {
  LocalTerms &rows = families_[0].clamped, &mollified = families_[1].clamped;
  if (options_.hessian_mode == HessianMode::gauss_newton) {
    rows.hess = families_[0].local.hess;  // positive semi-definite as it is
  } else {
    contact_terms(state_.rows, x, options_.hessian_mode, Projection::psd, rows.grad, rows.hess,
                  options_.precision);
  }
  mollified_terms(state_.mollified, x, Projection::psd, mollified.grad, mollified.hess, options_.precision);
}

void ContactTerm::add_given_motion(const PositionsView& x, const PositionsView& motion, PositionsSpan force) {
  bb::add_given_motion(state_.rows, motion, force);
  bb::add_given_motion(state_.mollified, x, motion, force);
}

void ContactTerm::add_loads(const PositionsView& x, ContactLoads& out) const {
  const std::size_t first = out.size();
  bb::add_loads(state_.rows, out);
  bb::add_loads(state_.mollified, x, out);
  if (carries_) carried_.give(first, out);
}

void ContactTerm::add_forces(const PositionsView& x, const PositionsView& x_n,
                             std::vector<ContactForce>& out) const {
  state_.for_each_table([&](const auto& rows) { bb::add_forces(rows, x, x_n, out); });
}

void ContactTerm::prepare(const Motion& motion, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::broad_phase);
  if (bounds_each_vertex(options_.contact_options.step_bound)) {
    contacts_.update_candidates_of_each(motion.x0, motion.x1);
  } else if (motion.to_bound) {
    contacts_.update_candidates_to_bound(motion.x0, motion.x1);
  } else {
    contacts_.update_candidates(motion.x0, motion.x1);
  }
}

StepBound ContactTerm::find_bound(const Motion& motion) {
  return bounds_each_vertex(options_.contact_options.step_bound)
             ? contacts_.vertex_bounds(motion.x0, motion.x1)
             : contacts_.step_bound(motion.x0, motion.x1);
}

StepBound ContactTerm::prove_step(const PositionsView& x_n, const PositionsView& x, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::step_bound);
  return contacts_.prove_step(x_n, x);
}

bool ContactTerm::add_curvature_correction(const PositionsView& x, const PositionsView& dx, double bound,
                                           PositionsSpan force) {
  return bb::add_curvature_correction(state_.rows, x, dx, force).by_curvature(bound);
}

std::span<const double> ContactTerm::vertex_parts() const {
  if (bounds_each_vertex(options_.contact_options.step_bound)) return contacts_.vertex_parts();
  return {};
}

bool ContactTerm::is_feasible(const PositionsView& x, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::contact_rows);
  trial_.gap_min = contacts_.find_rows(x, trial_.rows, trial_.mollified);
  return trial_.gap_min > 0 || options_.contact.literal || options_.overlap;
}

void ContactTerm::freeze(PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::stiffness);
  stiffness_.freeze(trial_.tables(), state_.tables(), pattern(), elastic_values());
}

void ContactTerm::evaluate(ContactState& state, const PositionsView& x, std::vector<double>& rows,
                           std::vector<double>& mollified) {
  fill_shape(state);
  contact_energies(state.rows, rows, options_.precision);
  mollified_energies(state.mollified, x, mollified, options_.precision);
}

void ContactTerm::evaluate(const PositionsView& x) {
  evaluate(trial_, x, families_[0].trial_energy, families_[1].trial_energy);
}

void ContactTerm::evaluate_iterate(const PositionsView& x) {
  evaluate(state_, x, families_[0].local.energy, families_[1].local.energy);
}

void ContactTerm::accept(PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::stiffness);
  std::swap(state_, trial_);
  use_state();
  stiffness_.keep(state_.tables());
}

void ContactTerm::add_constraints(const ConstraintRequest& request,
                                  std::vector<const ConstraintBatch*>& out) {
  {
    const ScopedPhase timer(request.clock, Phase::broad_phase);
    contacts_.update_candidates(request.x, request.x);
  }
  const ScopedPhase timer(request.clock, Phase::contact_rows);
  ContactState& found = constrained_;
  contacts_.find_rows(request.x, found.rows, found.mollified);
  const bool compliant = request.inequalities == Inequalities::compliant;
  ContactState none;  // nothing is linearised: no row has a kappa yet
  if (compliant) stiffness_.freeze(found.tables(), none.tables(), pattern(), elastic_values());
  constraints_.set(found.rows, found.mollified, request.x, compliant);
  out.push_back(&constraints_);
}

const ContactState& contact_state(const TermList& terms) {
  static const ContactState none;
  if (const ContactTerm* term = terms.find<ContactTerm>()) return term->state();
  const LinearContact* linear = terms.find<LinearContact>();
  return linear ? linear->state() : none;
}

PlanItem needs_contact(const TermNeeds& needs) {
  return plan_item(needs.contacts.any(), "something can touch", "nothing can touch");
}

void make_contact(const TermInputs& inputs, TermList& terms) {
  if (inputs.options.linear_contact) {
    return terms.add(std::make_unique<LinearContact>(inputs.scene, inputs.options, inputs.contacts));
  }
  terms.add(std::make_unique<ContactTerm>(inputs, terms));
}

}  // namespace bb
