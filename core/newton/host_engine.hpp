// E as a list of terms in the host's memory (core/terms). It knows no term by name.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/exec/host_executor.hpp"
#include "core/linear/block_system.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/model/scene/scene.hpp"
#include "core/newton/energy_sum.hpp"
#include "core/newton/incremental_potential.hpp"
#include "core/newton/method.hpp"
#include "core/terms/host_term.hpp"
#include "core/terms/plan.hpp"

namespace bb {

/// A column of the host's memory as points; nothing is copied.
inline PositionsView points(const Column& column) { return column; }
inline PositionsSpan points(Column& column) { return column; }

class HostEngine final : public IncrementalPotential {
 public:
  /// All arguments must outlive it. fixed: [3 n] prescribed or locked degrees of freedom.
  HostEngine(const Scene& scene, Method& method, const Plan& plan, const std::vector<std::uint8_t>& fixed,
             PhaseClock& clock);
  exec::Executor& executor() override { return executor_; }

  void keep_solver(Archive& archive) override;
  void drop_caches() override;
  /// The step that has begun is that of another potential: what is frozen there is known here.
  void adopt(const KnownStep& known);
  void adopt(const HostEngine& other);

  void leave_secants(const Column& x, const Column& g) override;
  bool pattern_changed() const override { return pattern_changed_; }
  void fill_matrix(const Column& x, const HessianRegularisation& level, const Column& force) override;
  void fill_exact(const Column& x, const Column& force) override;
  double add_tikhonov(double relative, double absolute) override;
  void multiply(const Column& v, Column& out) override;
  void solve(const Column& b, RightSide of, Column& step, SolveReport& report) override;
  Definiteness examine(const Column& x, const HessianRegularisation& near, const Column& force, Column& b,
                       Column& step, Column& direction) override;
  std::size_t nnz() const override { return nnz_; }

  double truncate(Column& dx) override;
  Cusps cusps(const Column& x, double t_end) override;
  std::string describe_non_finite() override;
  KnownStep known_step() const override;
  /// How many times the largest force of a bounded barrier the loads of a step without progress are. dx: the Newton
  /// direction at x, or 0.
  void report_overload(const Column& x, const Column& g, const Column& dx, StepNumbers& out);

 private:
  friend class Diagnosis;
  friend class ConstraintSystem;
  /// Where the families of a term are in the block system, whose families are fixed or changing.
  struct Slot {
    HostTerm* term;
    std::size_t first;
    StepHessian hessian;
    bool clamped;  // the term's clamped Hessians are those of this iterate
  };
  void solver_begins_step() override;
  void linearise_terms(const Column& x, Column& g) override;
  bool is_finite(Column& trial, bool seen_by_terms) override;
  bool bounds_each_vertex_of(const Term& term) const override;
  EnergyChange sum_change(const Column& x, const Column& trial) override;
  double sum_energy(TermSet set, const Column& x, bool announced) override;
  void set_fixed_families(const Method& method);
  void make_solver();
  bool set_changing_families();
  TermContext context(const PositionsView& gradient, StepHessian hessian = StepHessian::clamped) const {
    return {gradient, first_projection(hessian), clock()};
  }
  void linearise_term(Slot& slot, const Column& x, const Column& g);
  void add_families(const Slot& slot, PositionsSpan gradient) const;
  void add_gradient(const Slot& slot, Column& g);
  void clamp(Slot& slot);
  void clamp(TermSet set);
  template <class HessianOf>
  void sum_matrices(TermSet set, const HessianOf& hessian_of);
  void sum_clamped(TermSet set);
  static std::span<const double> clamped_hessians(const Slot& slot, const TermFamily& family);
  void sum_exact();
  const ReducedSystem& reduced();

  exec::HostExecutor executor_;
  const Scene& scene_;
  const Plan& plan_;
  const Precision precision_;
  TermList terms_;
  std::vector<Slot> slots_;                // one a term
  std::vector<std::size_t> matrix_order_;  // of the slots: H first, since its snapshot is taken there
  std::unique_ptr<BlockSystem> blocks_;
  std::unique_ptr<LinearSolver> solver_;  // where the plan needs one

  const Column* x_ = nullptr;  // the iterate that was linearised last
  Positions part_;
  BlockSystem::Values elastic_, full_;           // H where the plan needs it; all terms
  const BlockSystem::Values* filled_ = nullptr;  // the matrix that was filled last
  bool full_is_exact_ = false,
       exact_is_solved_ = false;  // nothing in it is clamped or shifted; it was solved last
  ReducedSystem examined_;        // the matrix that examine() tests
  EnergySums sums_;
  std::size_t nnz_ = 0;
  std::vector<double> hess_buffer_;
  bool pattern_changed_ = false;
  VecXd rhs_, solution_;
};

}  // namespace bb
