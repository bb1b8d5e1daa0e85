// Everything one Newton iteration asks of the scene: energies, gradient, matrix, contact rows, feasible step.
// It holds the state; the step solvers (line_search.cpp, accumulated_toi.cpp) hold the order of the steps.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/contact_system.hpp"
#include "core/energy/element_batch.hpp"
#include "core/energy/strain_limit_batch.hpp"
#include "core/linear/block_system.hpp"
#include "core/newton/energy_state.hpp"
#include "core/newton/method.hpp"
#include "core/newton/report.hpp"
#include "core/newton/stiffness_update.hpp"
#include "core/scene/scene.hpp"

namespace bb {

class NewtonSystem {
 public:
  /// scene and method must outlive the system.
  NewtonSystem(const Scene& scene, Method& method);

  // --- a step
  // -------------------------------------------------------------------------------------------------
  /// Starts a step at x_n. load_factor scales the external force (1, or the load step of quasi_static).
  void begin_step(const Positions& x_n, const Prediction& prediction, double dt, double load_factor);
  /// The same step with another prediction and length (accumulated_toi): state, rows and kept kappa stay.
  void restart_step(const Prediction& prediction, double dt);

  // --- an iterate
  // ---------------------------------------------------------------------------------------------
  /// Elastic terms, snapshot of H, kappa, limit, contact terms, gradient and matrix at state().x.
  void assemble();
  /// Newton direction: A dx = -(g + lifted prescribed motion). target: [3 x n], read at prescribed vertices
  /// only.
  LinearReport solve(const Positions& target, Positions& dx);

  // --- the step along dx
  // --------------------------------------------------------------------------------------
  /// Prepares candidates for every state between state().x and x1.
  void sweep(const Positions& x1);
  StepBound contact_bound(const Positions& x1) const;
  double limit_bound(const Positions& dx) const;
  /// Adds eps I to the assembled matrix, eps = max(relative trace / n, absolute); returns eps. What observers
  /// saw before is without it.
  double add_tikhonov(double relative, double absolute);
  /// Evaluates E at x with kappa frozen. Returns the change against state(); an infeasible x has no change.
  std::optional<EnergyChange> try_state(const Positions& x);
  /// Makes the last tried state the current one.
  void accept();

  // --- what observers and reports read
  // ------------------------------------------------------------------------
  const Scene& scene() const { return scene_; }
  /// Charges what happens in this system and round it to phases; the calls below and above switch it.
  PhaseClock& clock() const { return clock_; }
  const EnergyState& state() const { return state_; }
  const StepTerms& terms() const { return terms_; }
  const Positions& gradient() const { return gradient_; }
  double energy() const { return total_energy(terms_, state_); }
  double grad_inf() const;
  ContactCounts contact_counts() const;
  bool pattern_changed() const { return pattern_changed_; }
  int n_free() const { return blocks_->n_free(); }
  /// Largest relative change, max / min - 1, of a contact's kappa, and of an active limited element's, since
  /// the line search before, in the same step; 0 in a step's first iterate.
  double kappa_change() const { return kappa_change_; }
  double limit_kappa_change() const { return limit_kappa_change_; }
  /// Entries of the lower triangle that was solved last.
  std::size_t nnz() const { return nnz_; }
  bool has_limit() const { return limit_ != nullptr; }
  /// Of limited elements: largest sigma - 1; smallest distance y to the limit over its width, which is 1
  /// or more where no element is active.
  double max_stretch() const;
  double limit_gap_min_rel() const;
  /// SVD sweeps over the limited elements so far: one a state that was measured.
  long long limit_sweeps() const { return limit_ ? limit_->sweeps() : 0; }
  /// Largest (1/area) dS_e/dsigma over limited elements, N/m.
  double limit_load_max() const;
  /// Largest estimated load over capacity, over contact rows and over limited elements; 0 when the barrier is
  /// unbounded. dx: the Newton direction at state(), or 0.
  double contact_overload(const Positions& dx) const;
  double limit_overload(const Positions& dx);
  const ReducedSystem& reduced(MatrixStage stage);
  bool has_stage(MatrixStage stage) const;
  void keep_stages(bool keep) { keep_stages_ = keep; }
  BlockSystem& blocks() { return *blocks_; }
  const BlockSystem::Values& elastic_matrix() const { return elastic_; }
  StiffnessUpdate& stiffness() { return stiffness_; }
  ContactSystem& contacts() { return contacts_; }
  const std::vector<std::uint8_t>& fixed() const { return fixed_; }
  double min_d_hat() const { return min_d_hat_; }

 private:
  void build_elements();
  void evaluate_elements(EnergyState& state) const;
  void start_policy();
  void evaluate_shape(ContactTable& rows) const;
  void evaluate_shape(MollifiedTable& rows) const;
  void evaluate_contact_energies(EnergyState& state) const;
  void refresh_limit_stiffness();
  double times_larger(std::size_t e, const Positions& others) const;
  double limit_change() const;
  void assemble_limit();
  void assemble_matrix();
  void fill_contact_terms();
  void gather_gradient();
  void lift(const Positions& dx, Positions& rhs) const;
  LinearReport solve_reduced(const ReducedSystem& reduced);

  const Scene& scene_;
  Method& method_;
  std::vector<std::uint8_t> fixed_;  // [3 n] prescribed or locked
  std::vector<std::unique_ptr<EnergyBatch>> elements_;
  std::unique_ptr<StrainLimitBatch> limit_;
  ContactSystem contacts_;
  std::unique_ptr<BlockSystem> blocks_;
  std::unique_ptr<LinearSolver> solver_;
  StiffnessUpdate stiffness_;

  StepTerms terms_;
  double dt_ = 0, c_ = 1;
  double min_d_hat_ = 0;
  std::size_t nnz_ = 0;
  EnergyState state_, trial_;

  std::vector<LocalTerms> local_;
  LocalTerms limit_local_;
  std::vector<double> limit_kappa_, limit_kappa_before_, limit_hess_;
  bool limit_kappa_fresh_ = false, first_iterate_ = true;
  double kappa_change_ = 0, limit_kappa_change_ = 0;
  std::vector<double> contact_grad_, contact_hess_, mollified_grad_, mollified_hess_;
  Positions gradient_;  // of E
  Positions contact_gradient_;
  BlockSystem::Values elastic_, no_limit_, no_contact_, full_;
  bool keep_stages_ = false, pattern_changed_ = false, policy_started_ = false, need_elastic_ = false;
  VecXd rhs_, solution_;
  Positions work_;
  mutable PhaseClock clock_;
};

}  // namespace bb
