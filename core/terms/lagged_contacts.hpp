// A term of the CPU path that acts on the contacts of one state: a family of rows (lagged_family.hpp) in the host's memory, which it
// takes from the terms before it.
#pragma once

#include <vector>

#include "core/contact/contact_loads.hpp"
#include "core/terms/lagged_family.hpp"
#include "core/terms/registry.hpp"

namespace bb {

/// One element a contact whose coefficient is not 0, on the vertices of the contact, in the order of their pairs.
class LaggedContacts final : public Term {
 public:
  /// name: that of registry.inc. before: the terms whose contacts are meant; they outlive the term.
  LaggedContacts(std::string_view name, std::unique_ptr<LaggedFamily> family, const TermList& before);
  std::string_view name() const override { return name_; }
  TermGroup group() const override { return TermGroup::friction; }
  Phase phase() const override { return Phase::contact_terms; }
  bool fixed_stencils() const override { return false; }

  void begin_step(const StepFrame& frame, PhaseClock& clock) override;
  void change_frame(const StepFrame& frame) override { family_->change_step(frame.of_families()); }
  void adopt(const KnownStep& known) override;
  void adopt_from(const Term& other) override;
  bool renew_lag(const PositionsView& x) override;
  void end_step(const PositionsView& x, PhaseClock&) override { family_->end_step(x.data()); }
  void keep(Archive& archive) override { family_->keep(archive); }

  /// Errors: std::logic_error where the terms before, which have been linearised, hold other contacts than when the step began.
  void linearise(const PositionsView& x, const TermContext&) override;
  void evaluate(const PositionsView& x) override {
    family_->values(x.data(), families_[0].trial_energy.data());
  }
  void change(const PositionsView&, const PositionsView&, EnergyParts& out) const override {
    compare_elements(families_[0], out);  // the rows of a step stay
  }
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) override {
    if (family_->loads_known())
      family_->report_end(x.data(), out);  // else rows were taken anew where it ended
  }

 private:
  void take_rows(const PositionsView& x);
  void learn_loads();
  ContactLoads contacts_at(const PositionsView& x) const;
  void adopt(const KnownLag& lag);
  void make_elements();

  std::string_view name_;
  std::unique_ptr<LaggedFamily> family_;
  std::vector<const Term*> before_;
  std::vector<std::size_t> contact_;  // [n] the contact of each row
  std::vector<PairId> pairs_;         // of all contacts, as they were taken
  std::vector<int> vertices_;         // [4 n], row by row
};

/// Makes the term of a line of registry.inc.
void add_lagged(std::string_view name, MakeLagged make, const TermInputs& inputs, TermList& terms);

}  // namespace bb
