#include "core/terms/lagged_contacts.hpp"

#include <stdexcept>

namespace bb {

LaggedContacts::LaggedContacts(const Scene& scene, Precision precision, const TermList& before)
    : scene_(scene), precision_(precision) {
  for (const auto& term : before) before_.push_back(term.get());
  families_.resize(1);
}

void LaggedContacts::adopt(const KnownStep& known) {
  for (const KnownLag& lag : known.lags) {
    if (lag.term != name()) continue;
    lagged_ = lag.lagged;
    make_elements(lag.contacts);
    for (std::size_t e = 0; e < row_.size(); ++e) strength_[e] = lag.strength[row_[e]];
    loads_known_ = true;
    lag_is_adopted(lag.t);
  }
}

void LaggedContacts::adopt_from(const Term& other) {
  const auto& same = static_cast<const LaggedContacts&>(other);
  lagged_ = same.lagged_;
  make_elements(same.contacts_);
  strength_ = same.strength_;
  loads_known_ = same.loads_known_;
}

// The rows of a step stay.
void LaggedContacts::change(const PositionsView&, const PositionsView&, EnergyParts& out) const {
  compare_elements(families_[0], out);
}

void LaggedContacts::take_rows(const PositionsView& x) {
  lagged_ = x;
  make_elements(contacts_now());
  loads_known_ = false;
}

void LaggedContacts::learn_loads() {
  if (loads_known_) return;
  ContactLoads now = contacts_now();
  if (now.stencil != contacts_.stencil)
    throw std::logic_error("the rows of a lag changed before their loads");
  contacts_.load.swap(now.load);
  for (std::size_t e = 0; e < row_.size(); ++e) strength_[e] = coefficient_[e] * load(e);
  loads_are_known(strength_);
  loads_known_ = true;
}

ContactLoads LaggedContacts::contacts_now() const {
  ContactLoads out;
  for (const Term* term : before_) term->add_loads(lagged_, out);
  return out;
}

void LaggedContacts::make_elements(ContactLoads contacts) {
  contacts_ = std::move(contacts);
  row_.clear(), coefficient_.clear(), vertices_.clear();
  for (std::size_t r = 0; r < contacts_.size(); ++r) {
    const double of_contact = coefficient(r);
    if (of_contact == 0) continue;
    row_.push_back(r);
    coefficient_.push_back(of_contact);
    vertices_.insert(vertices_.end(), &contacts_.stencil[4 * r], &contacts_.stencil[4 * r] + 4);
  }
  strength_.assign(row_.size(), 0.0);
  families_[0].stencils = {4, vertices_};
  families_[0].local.resize(row_.size(), 4);
  families_[0].trial_energy.resize(row_.size());
}

}  // namespace bb
