// A term of the CPU path that acts on the contacts of one state: a family of rows (lagged_family.hpp) in the host's memory, which it
// takes from the terms before it.
#pragma once

#include <vector>

#include "core/contact/contact_forces.hpp"
#include "core/contact/contact_loads.hpp"
#include "core/terms/host_term.hpp"
#include "core/terms/lagged_steps.hpp"
#include "core/terms/term_inputs.hpp"

namespace bb {

/// One element a contact whose coefficient is not 0, on the vertices of the contact, in the order of their pairs; of the adopted step of
/// an executor one a contact.
class LaggedContacts final : public LaggedSteps<HostTerm> {
 public:
  /// name: that of registry.inc. before: the terms whose contacts are meant; they outlive the term.
  LaggedContacts(std::string_view name, std::unique_ptr<LaggedFamily> family, const TermList& before);
  bool fixed_stencils() const override { return false; }

  void adopt(const KnownStep& known) override;
  void adopt_from(const HostTerm& other) override;

  /// Nothing while loads are not known.
  void add_forces(const PositionsView& x, const PositionsView& x_n,
                  std::vector<ContactForce>& out) const override;

  /// Errors: std::logic_error where the terms before, which have been linearised, hold other contacts than when the step began.
  void linearise(const PositionsView& x, const TermContext&) override;
  void change(const PositionsView&, const PositionsView&, EnergyParts& out) const override {
    compare_elements(families_[0], out);  // the rows of a step stay
  }

 private:
  void take_rows(const PositionsView& x) override;
  void learn_loads();
  ContactLoads contacts_at(const PositionsView& x) const;
  void adopt(const LaggedState& lagged);
  void make_elements();

  std::vector<const HostTerm*> before_;
  std::vector<std::size_t> contact_;  // [n] the contact of each row
  std::vector<PairId> pairs_;         // of all contacts, as they were taken
  std::vector<int> vertices_;         // [4 n], row by row
};

/// Makes the term of a line of registry.inc.
void add_lagged(std::string_view name, MakeLagged make, const TermInputs& inputs, TermList& terms);

}  // namespace bb
