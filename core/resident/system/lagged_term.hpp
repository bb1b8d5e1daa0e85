// A term on an executor that acts on the contacts of one state: a family of rows (core/terms/lagged_family.hpp) in its memory.
#pragma once

#include "core/resident/contact/lagged_assembly.hpp"
#include "core/resident/elements/term_energies.hpp"
#include "core/resident/system/resident_contact.hpp"
#include "core/terms/lagged_steps.hpp"

namespace bb::resident {

class LaggedTerm final : public LaggedSteps<TermEnergies> {
 public:
  /// name: that of registry.inc. contact: the contacts that are meant; it outlives the term.
  LaggedTerm(const ResidentInputs& inputs, std::string_view name, std::unique_ptr<LaggedFamily> family,
             ResidentContact& contact);
  void drop_caches() override { matrix_ = {}; }

  // --- an iterate
  void linearise(const PositionsView& x, const ResidentContext&, PositionsSpan g) override;
  void add_matrix(const PositionsView& x, const HessianRequest&) override;
  ChangingMatrix changing_matrix() const override {
    return {matrix_, matrix_.row_begin ? assembly_.n_blocks() : 0};
  }
  bool pattern_changed() const override { return pattern_changed_; }
  void add_given_motion(const PositionsView& x, const PositionsView& motion, PositionsSpan force) override;

  // --- what is said of it
  void add_known(KnownStep& out) const override;

  // --- memory
  void expect(const ExpectedContacts& expected) override { assembly_.expect(expected); }

 private:
  void take_rows(const PositionsView& x) override;

  ResidentContact& contact_;
  LaggedAssembly assembly_;
  Column force_, hess_;
  MatrixPart matrix_{};
  bool taken_ = false, pattern_changed_ = false;
};

/// Makes the term of a line of registry.inc. Errors: std::logic_error without contact before it.
void add_lagged(std::string_view name, MakeLagged make, const ResidentInputs& inputs, ExecutorTerms& terms);

}  // namespace bb::resident
