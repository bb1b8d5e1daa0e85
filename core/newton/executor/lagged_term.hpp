// A term on an executor that acts on the contacts of one state: a family of rows (core/terms/lagged_family.hpp) in its memory.
#pragma once

#include "core/contact/executor/lagged_assembly.hpp"
#include "core/newton/executor/executor_contact.hpp"
#include "core/terms/executor/term_energies.hpp"
#include "core/terms/lagged_steps.hpp"

namespace bb::exec {

class LaggedTerm final : public LaggedSteps<TermEnergies> {
 public:
  /// name: that of registry.inc. contact: the contacts that are meant; it outlives the term.
  LaggedTerm(const ExecutorInputs& inputs, std::string_view name, std::unique_ptr<LaggedFamily> family,
             ExecutorContact& contact);
  void drop_caches() override { matrix_ = {}; }

  // --- an iterate
  void linearise(const PositionsView& x, const ExecutorContext&, PositionsSpan g) override;
  void add_matrix(const PositionsView& x, const HessianRequest&) override;
  ChangingMatrix changing_matrix() const override {
    return {matrix_, matrix_.row_begin ? assembly_.n_blocks() : 0};
  }
  bool pattern_changed() const override { return pattern_changed_; }
  void add_given_motion(const PositionsView& x, const PositionsView& motion, PositionsSpan force) override;

  // --- what is reported of it
  void add_known(KnownStep& out) const override;

  // --- memory
  void expect(const ExpectedContacts& expected) override { assembly_.expect(expected); }

 private:
  void take_rows(const PositionsView& x) override;

  ExecutorContact& contact_;
  LaggedAssembly assembly_;
  Column force_, hess_;
  MatrixPart matrix_{};
  bool taken_ = false, pattern_changed_ = false;
};

/// Makes the term of a line of registry.inc. Errors: std::logic_error without contact before it.
void add_lagged(std::string_view name, MakeLagged make, const ExecutorInputs& inputs, ExecutorTerms& terms);

}  // namespace bb::exec
