// Contact without a barrier, after Zheng, Luo and Li 2026 (Robust and Efficient Penetration-Free Elastodynamics without Barriers,
// arXiv 2512.12151). There are two states: the iterate of Newton, whose surfaces may overlap, and the anchor, which is free of
// contact always. Constraints are pairs that stopped the anchor on its way to an iterate:
//
//   c(x) = d(anchor) - delta + grad d(anchor) . (x - anchor) >= 0,   delta = min(standoff d_hat, d(x_n) + recovery_speed h),
//
// each with a force lambda >= 0 (N) and a weight gamma = decay^n, n the updates in a row in which it was not active. With one
// penalty mu (N/m) for all and slacks s = max(0, c - lambda/mu) that are fixed for an iteration, E gets
//
//   sum gamma mu/2 (c - s - lambda/mu)^2,
//
// whose Hessian gamma mu grad d grad d^T stands for every constraint, active or not. Where the iterate has settled for a fixed
// anchor: lambda := max(0, lambda - mu c); the anchor goes towards it as far as ACCD lets it; pairs that stopped it and are
// the first for one of their vertices become constraints with lambda = 0; those whose weight is below least_weight go.
// Constraints stay from step to step.
// Otherwise than there: a gap that is below its standoff at the start x_n of a step opens with `recovery_speed` at most. Theirs has
// delta = standoff d_hat, so that such a gap opens within one step, with a speed that grows without bound as h falls;
// forces and mu in N and N/m, theirs times h^2; the anchor goes `advance` of the way to its first contact,
// theirs to where a tenth of the gap is left; no friction, nothing prescribed that moves.
#pragma once

#include <vector>

#include "core/contact/motion_pairs.hpp"
#include "core/terms/contact.hpp"
#include "core/terms/host_term.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

class LinearContact final : public HostTerm {
 public:
  /// All must outlive it. Errors: ConfigError for collisions of chosen bodies.
  LinearContact(const Scene& scene, const TermOptions& options, const ContactPlan& plan);
  std::string_view name() const override { return "contact"; }
  TermGroup group() const override { return TermGroup::contact; }
  Phase phase() const override { return Phase::contact_terms; }
  bool fixed_stencils() const override { return false; }

  void begin_step(const StepColumns& step, PhaseClock& clock) override;
  void adopt_from(const HostTerm& other) override;
  void keep(Archive& archive) override;
  void linearise(const PositionsView& x, const TermContext& context) override;
  void clamp(const PositionsView& x) override;
  void evaluate(const PositionsView& x) override;
  void report(const PositionsView& x, IterateNumbers& out, PhaseClock& clock) override;
  /// Requires x to be the anchor.
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) override;

  // --- for the step solver
  /// mu of the step where the rules do not give it, N/m; > 0.
  void set_penalty(double penalty);
  /// The anchor is x [3 x n] m, free of contact: constraints are those of its gaps.
  void set_anchor(const PositionsView& x);
  const Positions& anchor() const { return anchor_; }
  /// Multipliers and weights after an iterate x has settled. @return the largest change of lambda/mu, m.
  double update(const PositionsView& x);
  struct Advance {
    double time = 1;     // part of anchor -> x that the anchor went
    StepBound bound;     // its alpha, and the earliest pair with counters
    bool known = false;  // whether that pair was a constraint
    std::size_t hits = 0, admitted = 0, dropped = 0;
  };
  /// Moves the anchor towards the iterate x, and takes up and drops constraints.
  Advance advance(const PositionsView& x, PhaseClock& clock);

  double penalty() const { return penalty_; }
  double largest_force() const;
  std::size_t n_constraints() const { return constraints_.size(); }
  /// max(0, -c) at the anchor, m.
  double violation() const;
  /// The largest speed (m/s) by which a constraint with a force has opened the anchor's gap beyond what it requests: a force at a
  /// distance, 0 where multipliers have converged.
  double opening_speed() const;
  int adaptations() const { return adaptations_; }
  /// Rows at the last step end, with the forces of their constraints.
  const ContactState& state() const { return end_; }

 private:
  struct Constraint {
    PairId pair = 0;
    double force = 0;  // lambda, N
    int quiet = 0;     // n
    LinearGap at;      // the anchor
    double most = 0;   // m, required in the step: d(x_n) plus what comes back in the step
    double slack = 0;  // s, m
    void keep(Archive& archive);
  };
  double value(const Constraint& of, const PositionsView& x) const;
  double asked(const Constraint& of) const;
  double most_asked(PairId pair) const;
  double weight(const Constraint& of) const;
  void linearise_constraints();
  void list_stencils();
  double take_hits(const std::vector<MotionHit>& hits, Advance& out);
  void renew_constraints(Advance& out);
  void note_stall(double time);
  const Constraint* find(PairId pair) const;
  template <class Table>
  void fill_loads(Table& rows) const;

  const TermOptions& options_;
  const LinearContactRules rules_;
  MotionPairs pairs_;
  ContactSystem contacts_;                        // of the rows at step ends
  std::vector<Constraint> constraints_, merged_;  // ascending by pair
  std::vector<MotionHit> fresh_;
  std::vector<double> earliest_;  // [n_vertices] time of the first fresh hit of each
  std::vector<int> stencil_;      // [4 n]
  Positions anchor_, x_n_;
  double dt_ = 0;  // s
  double penalty_ = 1, standoff_ = 0.1;
  int stalled_ = 0, adaptations_ = 0;
  ContactState end_;
};

}  // namespace bb
