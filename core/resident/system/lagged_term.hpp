// A term on an executor that acts on the contacts of one state: a family of rows (core/terms/lagged_family.hpp) in its memory.
#pragma once

#include "core/resident/contact/lagged_assembly.hpp"
#include "core/resident/system/resident_contact.hpp"

namespace bb::resident {

class LaggedTerm final : public ResidentTerm {
 public:
  /// name: that of registry.inc. contact: the contacts that are meant; it outlives the term.
  LaggedTerm(const ResidentInputs& inputs, std::string_view name, std::unique_ptr<LaggedFamily> family,
             ResidentContact& contact);
  std::string_view name() const override { return name_; }
  TermGroup group() const override { return TermGroup::friction; }
  Phase phase() const override { return Phase::contact_terms; }

  // --- a step
  void begin_step(const ResidentFrame& frame) override;
  void change_frame(const ResidentFrame& frame) override { family_->change_step(frame.of_families()); }
  bool renew_lag(const Column& x) override;
  void end_step(const Column& x, PhaseClock&) override { family_->end_step(x.data()); }
  void keep(Archive& archive) override;
  void drop_caches() override { matrix_ = {}; }

  // --- an iterate
  void linearise(const Column& x, const ResidentContext&, Column& g) override;
  void add_matrix(const Column& x, const HessianRequest&) override;
  ChangingMatrix changing_matrix() const override {
    return {matrix_, matrix_.row_begin ? assembly_.n_blocks() : 0};
  }
  bool pattern_changed() const override { return pattern_changed_; }
  void add_given_motion(const Column& x, const Column& motion, Column& force) override;

  // --- a trial state
  void evaluate(const Column& trial) override { family_->values(trial.data(), trial_energy_.data()); }
  void add_change(const Column&, const Column&, ResidentChange& out) override {
    out.add(family_->size(), energy_.data(), trial_energy_.data());
  }
  void take_energies() override { energy_.swap(trial_energy_); }
  void evaluate_iterate(const Column& x) override { family_->values(x.data(), energy_.data()); }

  // --- what is said of it
  void add_energy(const Column&, ResidentEnergy& out) override {
    out.add(family_->size(), nullptr, energy_.data());
  }
  Index first_not_finite(ResidentLeast& least) override;
  void report_end(const Column& x, StepNumbers& out) override;
  void add_known(KnownStep& out) const override;

  // --- memory
  void expect(const ExpectedContacts& expected) override { assembly_.expect(expected); }

 private:
  void take_rows(const Column& x);

  std::string_view name_;
  std::unique_ptr<LaggedFamily> family_;
  exec::Executor& executor_;
  ResidentContact& contact_;
  LaggedAssembly assembly_;
  Column energy_, trial_energy_, force_, hess_;
  MatrixPart matrix_{};
  bool taken_ = false, pattern_changed_ = false;
};

/// Makes the term of a line of registry.inc. Errors: std::logic_error without contact before it.
void add_lagged(std::string_view name, MakeLagged make, const ResidentInputs& inputs,
                ResidentTermList& terms);

}  // namespace bb::resident
