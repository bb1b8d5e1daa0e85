// The contact term B. Contact rows and mollified rows are one term with two families: they share the broad
// phase and the memory of kappa, since an edge-edge pair keeps its kappa when it becomes mollified and back.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/barrier/folded_barrier.hpp"
#include "core/barrier/gap_potential.hpp"
#include "core/contact/contact_system.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "core/terms/carried_loads.hpp"
#include "core/terms/contact_constraints.hpp"
#include "core/terms/contact_steps.hpp"
#include "core/terms/contact_stiffness.hpp"
#include "core/terms/host_term.hpp"
#include "core/terms/known_step.hpp"
#include "core/terms/registry.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// Rows of one state.
struct ContactState {
  ContactTable rows;
  MollifiedTable mollified;
  double gap_min = std::numeric_limits<double>::infinity();  // m; infinity without rows

  std::size_t size() const { return rows.size() + mollified.size(); }
  ContactTables tables() { return {rows, mollified}; }
  /// f(rows), f(mollified).
  template <class F>
  void for_each_table(const F& f) const {
    f(rows);
    f(mollified);
  }
};

class ContactTerm final : public ContactSteps<HostTerm> {
 public:
  /// All arguments must outlive the term. terms: with those of lines before.
  ContactTerm(const TermInputs& inputs, const TermList& terms);
  bool fixed_stencils() const override { return false; }

  void begin_step(const StepColumns& step, PhaseClock& clock) override;
  void change_step(const StepColumns& step) override;
  /// Updates multipliers, where there are some (contact_multipliers.hpp).
  bool renew_lagged_state(const PositionsView& x) override;
  /// Keeps the loads where multipliers are part of them.
  void end_step(const PositionsView& x, PhaseClock& clock) override;
  void adopt(const KnownStep& known) override { adopt_stiffness(known.stiffness); }
  void adopt_from(const HostTerm& other) override {
    const auto& of = static_cast<const ContactTerm&>(other);
    adopt_stiffness(of.stiffness_.known());
    if (beside_) beside_->adopt(*of.beside_);
  }
  void keep(Archive& archive) override;
  void linearise(const PositionsView& x, const TermContext& context) override;
  void clamp(const PositionsView& x) override;
  void add_given_motion(const PositionsView& x, const PositionsView& motion, PositionsSpan force) override;
  void add_loads(const PositionsView& x, ContactLoads& out) const override;
  void add_forces(const PositionsView& x, const PositionsView& x_n,
                  std::vector<ContactForce>& out) const override;
  void prepare(const Motion& motion, PhaseClock& clock) override;
  void bound_audited(bool bound) override { contacts_.bound_audited(bound); }
  StepBound prove_step(const PositionsView& x_n, const PositionsView& x, PhaseClock& clock) override;
  std::span<const double> vertex_parts() const override;
  bool add_curvature_correction(const PositionsView& x, const PositionsView& dx, double bound,
                                PositionsSpan force) override;
  bool is_feasible(const PositionsView& x, PhaseClock& clock) override;
  void freeze(PhaseClock& clock) override;
  void evaluate(const PositionsView& x) override;
  void evaluate_iterate(const PositionsView& x) override;
  void accept(PhaseClock& clock) override;
  bool offers_constraints() const override { return true; }
  void add_constraints(const ConstraintRequest& request, std::vector<const ConstraintBatch*>& out) override;
  void report_overload(const PositionsView& x, const PositionsView& others, const PositionsView& dx,
                       StepNumbers& out) override;

  const ContactState& state() const { return state_; }
  const ContactSystem& contacts() const { return contacts_; }
  ContactStiffness& stiffness() { return stiffness_; }
  /// The iterate was accepted: updates the multipliers beside the barrier (barrier_multipliers.hpp). Whether E has changed,
  /// so that the iterate has to be linearised again. Requires options with barrier_multipliers.
  bool update_beside();
  const BarrierMultiplierCounts& beside() const { return beside_->counts(); }
  /// In the step. Requires options with multipliers.
  int multiplier_updates() const { return multipliers_->updates(); }

 private:
  void adopt_stiffness(const KnownStiffness& known) {
    stiffness_.adopt(known);
    policy_start_.set_started(true);  // or not yet: that is for the other system to do
  }
  RowTotals totals(const PositionsView& x) override;
  double smallest_gap() const override { return state_.gap_min; }
  double largest_coordinate(const PositionsView& x) override { return x.cwiseAbs().maxCoeff(); }
  void visit_rows(const PositionsView& x, const std::function<void(const EndRow&)>& f) override;
  double kappa_change() const override { return kappa_change_; }
  std::optional<StartSums> start_sums(const PositionsView& x, const PositionsView& others) override;
  StepBound find_bound(const Motion& motion) override;
  bool has_multipliers() const { return multipliers_ || beside_; }
  void use_state();
  void fill_shape(ContactState& state);
  void evaluate(ContactState& state, const PositionsView& x, std::vector<double>& rows,
                std::vector<double>& mollified);
  void fill_local(const PositionsView& x, Projection projection);
  void scale_multipliers();
  void carry_loads(const PositionsView& x);

  const std::vector<std::uint8_t>& fixed_;
  const TermList& terms_;
  ContactSystem contacts_;
  ContactStiffness stiffness_;
  std::optional<FoldedBarrier> folded_;  // where the policy has a potential: of kappa that falls as 1/d^2,
  std::optional<GapPotential> gap_potential_;  // of any kappa(d)
  std::optional<ContactMultipliers> multipliers_;
  std::optional<BarrierMultipliers> beside_;  // the barrier
  CarriedLoads carried_;                      // over the start of a step, where there are multipliers
  bool carries_ = false;                      // the loads of the iterate are those that were carried
  ContactState state_, trial_;
  ContactState constrained_;  // rows that add_constraints() found last
  ContactConstraints constraints_;
  double kappa_change_ = 0;
  bool first_iterate_ = true;
};

/// What is reported at the end of a step of rows that have kappa, b and its derivatives.
void report_end_of(const ContactState& state, Precision precision, const PositionsView& x, StepNumbers& out);

/// The rows among these terms; empty tables where the plan has no contact.
const ContactState& contact_state(const TermList& terms);

}  // namespace bb
