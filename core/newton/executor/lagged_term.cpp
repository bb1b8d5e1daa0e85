#include "core/newton/executor/lagged_term.hpp"

#include <stdexcept>

namespace bb::exec {

LaggedTerm::LaggedTerm(const ExecutorInputs& inputs, std::string_view name,
                       std::unique_ptr<LaggedFamily> family, ExecutorContact& contact)
    : LaggedSteps(name, std::move(family), inputs.executor, "lagged", 0),
      contact_(contact),
      assembly_(executor_, family_->rows(), inputs.scene.n_vertices()),
      force_(executor_, "lagged forces"),
      hess_(executor_, "lagged Hessians") {}

// Requires x to be the iterate.
void LaggedTerm::take_rows(const PositionsView& x) {
  assembly_.take(contact_.rows(x));
  family_->take(x.data(), x.size());
  const Index n = family_->size();
  fit_energies(n), force_.fit(3 * n);
  matrix_ = {};
  taken_ = true;
}

void LaggedTerm::linearise(const PositionsView& x, const ExecutorContext&, PositionsSpan g) {
  pattern_changed_ = taken_;
  taken_ = false;
  if (!family_->loads_known()) {
    assembly_.learn(contact_.forces(x));
    family_->know_loads();
  }
  family_->gradients(x.data(), energies(), force_.data());
  assembly_.add_forces(force_.data(), g);
}

void LaggedTerm::add_matrix(const PositionsView& x, const HessianRequest&) {
  matrix_ = {};
  if (family_->size() == 0) return;
  hess_.fit(6 * family_->size());
  family_->hessians(x.data(), hess_.data());
  matrix_ = assembly_.matrix(hess_.data());
}

void LaggedTerm::add_given_motion(const PositionsView& x, const PositionsView& motion, PositionsSpan force) {
  family_->changes(x.data(), motion.data(), force_.data());
  assembly_.add_forces(force_.data(), force);
}

void LaggedTerm::add_known(KnownStep& out) const {
  if (family_->loads_known()) out.lagged.push_back(family_->known(name_));
}

namespace {

/// The contacts that terms of later lines read. Errors: std::logic_error without any.
ExecutorContact& contact_of(ExecutorTerms& terms) {
  ExecutorContact* contact = terms.find<ExecutorContact>();
  if (!contact) throw std::logic_error("a term on contacts without contact");
  return *contact;
}

}  // namespace

void add_lagged(std::string_view name, MakeLagged make, const ExecutorInputs& inputs, ExecutorTerms& terms) {
  ExecutorContact& contact = contact_of(terms);
  auto family = make({inputs.executor}, inputs.scene, inputs.options, contact.surface().view().body);
  terms.add(std::make_unique<LaggedTerm>(inputs, name, std::move(family), contact));
}

}  // namespace bb::exec
