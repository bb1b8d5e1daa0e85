// E as a sum of terms at one iterate and one trial state, on the CPU. It knows no term by name; the step solvers
// (line_search.cpp, accumulated_toi.cpp) hold the order of the calls.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/integrators/integrator.hpp"
#include "core/linear/block_system.hpp"
#include "core/newton/energy_sum.hpp"
#include "core/newton/hessian_level.hpp"
#include "core/newton/method.hpp"
#include "core/newton/report.hpp"
#include "core/newton/step_system.hpp"
#include "core/scene/scene.hpp"
#include "core/terms/plan.hpp"
#include "core/terms/term.hpp"

namespace bb {

/// [3 n] 1 where a degree of freedom is prescribed or, in a planar scene, locked.
std::vector<std::uint8_t> fixed_dofs(const Scene& scene, const Plan& plan);
/// [n] m, size of the body of each vertex at rest: the largest side of its box.
std::vector<double> body_sizes(const Scene& scene);
/// Of the terms of the plan.
ExactHessians exact_hessians(const Plan& plan, const Method& method);
/// Of a method that is run without a config.
PlanOptions plan_options(const Method& method);

class NewtonSystem final : public StepSystem {
 public:
  /// scene and method must outlive the system. plan: of both; the terms are made from it.
  NewtonSystem(const Scene& scene, Method& method, const Plan& plan);
  /// With the plan of scene and method alone.
  NewtonSystem(const Scene& scene, Method& method);

  // --- a step
  /// Starts a step at x_n. load_factor scales the external force (1, or the load step of quasi_static).
  void begin_step(const Positions& x_n, const Prediction& prediction, double dt, double load_factor) override;
  /// The same step and iterate with another prediction and length (accumulated_toi).
  void restart_step(const Prediction& prediction, double dt) override;
  void end_step() override;
  /// What the terms remember from step to step.
  void keep(Archive& archive) override;
  /// The iterate x of another system in a step that began as `frame` says, assembled: what is read of it here is what
  /// that system has, its right-hand side included. target: [3 x n], read at prescribed vertices. known: stiffness of
  /// pairs that is frozen for the step. Policies are asked and not told: none starts here. Cost: two assemblies. Errors:
  /// std::logic_error for an x that is not feasible.
  void adopt(const StepFrame& frame, const Positions& x, const Positions& target, const HessianLevel& level,
             const KnownStiffness& known);
  /// The same of another system on the CPU, made from the same scene and method; prescribed vertices stay.
  void adopt(const StepFrame& frame, const NewtonSystem& other);
  /// Makes the linear solver anew and forgets the pattern of the contacts: between steps.
  void drop_caches() override;
  void keep_solver(Archive& archive) override;

  // --- an iterate
  /// Every term at x(), then gradient and matrix. Order of the sums: docs/design.md, Terms.
  void assemble() override;
  /// Adds eps I to the assembled matrix, eps = max(relative trace / n, absolute); returns eps. It stays until
  /// the next assemble(), in the matrix that is solved only.
  double add_tikhonov(double relative, double absolute) override;
  /// Newton direction: A dx = -(g + lifted prescribed motion). target: [3 x n], read at prescribed vertices
  /// only. While the matrix is not positive definite, or dx does not descend, the Hessian is brought nearer to
  /// the clamped one as its terms' choices allow (StepHessian). Cost: an assembly and a solve an attempt.
  SolveReport solve(const Positions& target, Positions& dx);
  /// dx^T H dx, J, of the exact Hessian where a term began with it, of its own choice elsewhere. Requires
  /// assemble() at x(). Cost: an assembly.
  double exact_curvature(const Positions& dx);

  // --- the step along dx
  /// Prepares bound() and trials on the way to x1 = x() + dx; to_bound: bound() will be asked, and no trial
  /// goes beyond it.
  void prepare(const Positions& x1, const Positions& dx, bool to_bound = false);
  /// Largest feasible fraction of that way, the smallest that any term allows; each says its own
  /// in the report.
  double bound(const Positions& x1, const Positions& dx, IterationReport& report);
  /// What held the last bound(); empty where nothing did.
  std::string describe_bound() const override { return holder_ ? holder_->describe_bound() : std::string(); }
  /// Evaluates E at x, rounded to the precision of the run, with what the terms keep for an iterate. Returns the change against x(); an infeasible
  /// x has none.
  std::optional<EnergyChange> try_state(const Positions& x);
  /// Makes the last tried state the iterate.
  void accept() override;

  // --- the same with the vectors that belong to the system (step_system.hpp)
  void set_target(const Positions& target) override { target_ = target; }
  void hold() override { target_ = x_; }
  bool at_target() const override;
  SolveReport find_direction() override { return solve(target_, dx_); }
  DirectionSize direction_size() override;
  void scale_direction(double factor) override { dx_ *= factor; }
  double direction_curvature() override { return exact_curvature(dx_); }
  EndCheck check_end() override;
  void aim_at_escape(double length) override;
  void prepare_motion(MotionEnd end, bool to_bound) override;
  double bound_motion(IterationReport& report) override { return bound(motion_end_, dx_, report); }
  bool make_detour(double bound, SolveReport& report) override;
  void restore_direction() override { dx_.swap(straight_); }
  std::optional<EnergyChange> try_motion(double alpha) override;
  const Positions& x_before() const override { return trial_; }
  const Positions& target() const { return target_; }
  const Positions& direction() const { return dx_; }
  NewtonSystem& on_cpu() override { return *this; }
  bool is_on_cpu() const override { return true; }

  // --- what observers and reports read
  const Scene& scene() const override { return scene_; }
  const TermList& terms() const { return terms_; }
  const HessianLevel& level() const { return level_; }
  Precision precision() const override { return precision_; }
  const Positions& x() const override { return x_; }
  const Positions& gradient() const override { return gradient_; }
  double grad_inf() const override;
  /// E at the iterate, J; for the record only.
  double energy() const override { return total_energy(terms_); }
  /// The parts of E that a group has, J, each family summed for itself.
  double energy(TermGroup group) const override;
  bool pattern_changed() const override { return pattern_changed_; }
  int n_free() const override { return blocks_->n_free(); }
  /// Entries of the lower triangle that was solved last.
  std::size_t nnz() const override { return nnz_; }
  /// [3 n] prescribed or locked degrees of freedom.
  const std::vector<std::uint8_t>& fixed() const override { return fixed_; }
  const BlockSystem& blocks() const { return *blocks_; }
  /// Whether a group has elements at the iterate.
  bool active(TermGroup group) const;
  /// The matrix that was solved last, without eliminated degrees of freedom; valid until the next call of
  /// these two.
  const ReducedSystem& solved();
  /// That of some terms with every element clamped. Cost: an assembly, and the clamped elements if no attempt
  /// needed them.
  const ReducedSystem& clamped(TermSet set = TermSet::all());
  /// The same with eliminated degrees of freedom.
  const BlockSystem::Values& clamped_values(TermSet set);
  /// Calls visit for every family of the set's terms that has Hessians, with those that clamped(set) sums: lower blocks,
  /// element by element. Cost: the clamped elements if no attempt needed them.
  using VisitHessians =
      std::function<void(const Term& term, std::size_t family, std::span<const double> hess)>;
  void visit_clamped(TermSet set, const VisitHessians& visit);
  /// That of all terms with the Hessian that each begins with: the exact one where its choice has it. Valid
  /// until the next call of any of these. Cost: an assembly.
  const ReducedSystem& exact();
  /// Right-hand side of the system that was solved last, with what prescribed motion adds.
  const VecXd& rhs() const { return rhs_; }
  /// The matrix of the elements that every iterate has, all values 0; valid until the
  /// next call of any of these.
  const ReducedSystem& fixed_pattern();
  /// Whether no element of the solved matrix was clamped that its choice begins with exact.
  bool solved_is_exact() const override { return level_.exact(); }
  /// Whether the two are one: no term began with another Hessian, or the last attempt clamped all.
  bool solved_is_clamped() const { return level_.all_clamped() && shift_ == 0; }
  /// What the terms say of the iterate, of the end of a step, of a step without progress (dx: the Newton
  /// direction, or 0).
  void report(IterateNumbers& out) const override;
  void report_end(StepNumbers& out) const override;
  void report_overload(const Positions& dx, StepNumbers& out) const;
  void report_overload(bool with_direction, StepNumbers& out) override;
  /// The first element of the iterate with an energy, force or Hessian that is not finite, or else the first
  /// vertex with such a gradient or direction. dx: the Newton direction.
  std::string describe_non_finite(const Positions& dx) const;
  std::string describe_non_finite() const override { return describe_non_finite(dx_); }

 private:
  /// Where the families of a term are in the block system, whose families are fixed or changing.
  struct Slot {
    Term* term;
    std::size_t first;
    StepHessian hessian;
    bool clamped;  // the term's clamped Hessians are those of this iterate
  };
  TermContext context(StepHessian hessian = StepHessian::clamped) const {
    return {*blocks_, elastic_, gradient_, first_projection(hessian), clock()};
  }
  void set_fixed_families(const Method& method);
  void go_to(const Positions& x, const Positions& target, const HessianLevel& level);
  bool set_changing_families();
  void linearise(Slot& slot);
  void add_families(const Slot& slot, Positions& gradient) const;
  void add_gradient(const Slot& slot);
  void clamp(Slot& slot);
  template <class HessianOf>
  void sum_matrices(TermSet set, const HessianOf& hessian_of);
  void sum_clamped(TermSet set);
  void clamp(TermSet set);
  static std::span<const double> clamped_hessians(const Slot& slot, const TermFamily& family);
  void sum_exact();
  void fill_matrix();
  double largest_force();
  void lift(const Positions& dx, Positions& rhs);
  bool set_right_hand_side(const Positions& target, Positions& dx);
  bool direction(const Positions& target, Positions& dx, SolveReport& report);
  void solve_reduced(const VecXd& rhs, SolveReport& report);

  const Scene& scene_;
  const Plan plan_;
  const Precision precision_;
  const std::vector<std::uint8_t> fixed_;
  TermList terms_;
  std::vector<Slot> slots_;                // one a term
  std::vector<std::size_t> matrix_order_;  // of the slots: H first, since its snapshot is taken there
  HessianLevel level_;
  const ExactHessians exact_hessians_;
  const std::vector<double> body_size_;  // [n] m
  bool factored_ = false;                // the last solve made a factor of the matrix that it solved
  bool served_at_once_ = false;  // the first matrix of the last solve did: the next may be nearer to exact
  std::unique_ptr<BlockSystem> blocks_;
  std::unique_ptr<LinearSolver> solver_;

  StepFrame frame_;
  Positions x_, trial_;
  Positions target_, dx_, motion_end_, moved_;
  Positions straight_;               // dx before its detour or an escape
  Positions escape_;                 // a direction of negative curvature at the iterate
  ReducedSystem examined_;           // the matrix that check_end() asks about
  MotionEnd end_ = MotionEnd::free;  // of the motion in progress
  Positions gradient_;               // of E; while it is summed, of the terms so far
  Positions part_, work_;
  BlockSystem::Values elastic_, full_;  // H where the plan needs it; all terms
  EnergySums sums_;
  const Term* holder_ = nullptr;  // of the last bound
  std::size_t nnz_ = 0;
  double shift_ = 0;           // N/m, what add_tikhonov added
  std::vector<double> force_;  // [n] N, |g| of each free vertex
  std::vector<double> hess_buffer_;
  bool pattern_changed_ = false;
  VecXd rhs_, solution_;
};

}  // namespace bb
