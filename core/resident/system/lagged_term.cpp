#include "core/resident/system/lagged_term.hpp"

#include <stdexcept>

#include "core/exec/sums/vector_kernels.hpp"

namespace bb::resident {

LaggedTerm::LaggedTerm(const ResidentInputs& inputs, std::string_view name,
                       std::unique_ptr<LaggedFamily> family, ResidentContact& contact)
    : name_(name),
      family_(std::move(family)),
      executor_(inputs.executor),
      contact_(contact),
      assembly_(executor_, family_->rows(), inputs.scene.n_vertices()),
      energy_(executor_, "lagged energies"),
      trial_energy_(executor_, "lagged energies of the trial"),
      force_(executor_, "lagged forces"),
      hess_(executor_, "lagged Hessians") {}

void LaggedTerm::begin_step(const ResidentFrame& frame) {
  family_->begin_step(frame.of_families());
  take_rows(*frame.x_n);
}

bool LaggedTerm::renew_lag(const Column& x) {
  if (!family_->renews()) return false;
  const bool had_rows = family_->size() > 0;
  take_rows(x);
  return had_rows || family_->size() > 0;
}

void LaggedTerm::keep(Archive& archive) {
  ResidentTerm::keep(archive);
  family_->keep(archive);
}

// Requires x to be the iterate.
void LaggedTerm::take_rows(const Column& x) {
  assembly_.take(contact_.rows(x));
  family_->take(x.data(), x.size());
  const Index n = family_->size();
  energy_.fit(n), trial_energy_.fit(n), force_.fit(3 * n);
  matrix_ = {};
  taken_ = true;
}

void LaggedTerm::linearise(const Column& x, const ResidentContext&, Column& g) {
  pattern_changed_ = taken_;
  taken_ = false;
  if (!family_->loads_known()) {
    assembly_.learn(contact_.forces(x));
    family_->know_loads();
  }
  family_->gradients(x.data(), energy_.data(), force_.data());
  assembly_.add_forces(force_.data(), g);
}

void LaggedTerm::add_matrix(const Column& x, const HessianRequest&) {
  matrix_ = {};
  if (family_->size() == 0) return;
  hess_.fit(6 * family_->size());
  family_->hessians(x.data(), hess_.data());
  matrix_ = assembly_.matrix(hess_.data());
}

void LaggedTerm::add_given_motion(const Column& x, const Column& motion, Column& force) {
  family_->changes(x.data(), motion.data(), force_.data());
  assembly_.add_forces(force_.data(), force);
}

Index LaggedTerm::first_not_finite(ResidentLeast& least) {
  least.clear();
  executor_.each(family_->size(), FirstNotFinite{energy_.data(), least.data()});
  return least.first();
}

void LaggedTerm::report_end(const Column& x, StepNumbers& out) {
  if (family_->loads_known()) family_->report_end(x.data(), out);  // else rows were taken anew where it ended
}

void LaggedTerm::add_known(KnownStep& out) const {
  if (family_->loads_known()) out.lags.push_back(family_->known(name_));
}

namespace {

/// The contacts that terms of later lines read. Errors: std::logic_error without any.
ResidentContact& contact_of(ResidentTermList& terms) {
  ResidentContact* contact = terms.find<ResidentContact>();
  if (!contact) throw std::logic_error("a term on contacts without contact");
  return *contact;
}

}  // namespace

void add_lagged(std::string_view name, MakeLagged make, const ResidentInputs& inputs,
                ResidentTermList& terms) {
  ResidentContact& contact = contact_of(terms);
  auto family = make({inputs.executor}, inputs.scene, inputs.options, contact.surface().view().body);
  terms.add(std::make_unique<LaggedTerm>(inputs, name, std::move(family), contact));
}

}  // namespace bb::resident
