// Stiffness policy `formula`: kappa of every contact as a formula that the config gives.
#pragma once

#include <memory>
#include <string>

#include "barriers/formulas.hpp"
#include "core/barrier/gap_stiffness.hpp"
#include "core/barrier/stiffness_policy.hpp"

namespace bb {

/// Whether the force kappa(d) b'(d) comes from a potential, or kappa is a number that is not differentiated.
enum class FormulaPotential { none, derived };

/// Compiled as a plugin (barriers/formulas.hpp). Without a potential kappa is a number of the iterate or of the step; derived
/// (core/barrier/gap_potential.hpp), m and k of a pair are those of the state where it was first met in the step.
struct Formula {
  std::string formula;
  Refresh refresh = Refresh::per_iteration;
  FormulaPotential potential = FormulaPotential::none;

  static constexpr double largest_slope_error =
      1e-6;  // as analysis/src/barrierbench_analysis/program/formula/accuracy.py requires of a barrier's terms

  template <class List>
  static void describe(List& list) {
    list.text("formula", &Formula::formula, most_formula_bytes,
              "kappa in N/m of m and k (w^T M w and w^T H w over w^T w of the contact, kg and N/m), h (s), c "
              "(of the inertia M/(c h^2)), d and d_hat (m): m/(c*h^2) + k");
    list.refresh(&Formula::refresh);
    list.optional_choice(
        "potential", &Formula::potential, {"none", "derived"},
        "none, as without the key: kappa'(d) is left out of the curvature; derived: the force comes "
        "from -int kappa(s) b'(s) ds, by quadrature");
  }
  template <class Refuse>
  void check(Refuse& refuse) const {
    if (formula.empty()) return refuse("formula", "nothing", "a formula such as m/(c*h^2) + k");
    try {
      const FormulaPolicy policy = require_policy_formula(formula, "");
      if (potential == FormulaPotential::derived) check_potential(policy, refuse);
    } catch (const ConfigError& error) {
      for (const Violation& wrong : error.violations()) refuse("formula", wrong.found, wrong.allowed);
    }
  }
  class Policy;

 private:
  template <class Refuse>
  void check_potential(const FormulaPolicy& policy, Refuse& refuse) const {
    if (!policy.reads_gap) {
      refuse("potential", "\"derived\" with " + policy.formula,
             "none, or a formula that reads d: this kappa does not depend on the gap");
    } else if (!(policy.slope_error <= largest_slope_error)) {
      refuse("potential",
             "\"derived\" with a kappa'(d) that double precision has to " +
                 std::to_string(policy.slope_error) + " of kappa/d",
             "none, or a formula without differences of near numbers");
    }
    if (refresh != Refresh::per_step) {
      refuse("refresh", "\"per_iteration\"", "per_step, or potential none: a potential is frozen for a step");
    }
  }
};

class Formula::Policy final : public StiffnessPolicy, public GapStiffness {
 public:
  Policy(const Formula& values, double multiplier)
      : made_(require_policy_formula(values.formula, "stiffness_policy/formula")),
        of_plugin_(made_.policy.make(values.refresh, multiplier)),
        multiplier_(multiplier),
        derived_(values.potential == FormulaPotential::derived) {}
  std::string_view name() const override { return "formula"; }
  Refresh refresh() const override { return of_plugin_->refresh(); }
  bool needs_hessian() const override { return of_plugin_->needs_hessian(); }
  void fill(const StiffnessBatch& rows, double* kappa) const override { of_plugin_->fill(rows, kappa); }

  bool has_potential() const override { return derived_; }
  const GapStiffness* gap_stiffness() const override { return derived_ ? this : nullptr; }
  void set_time(const StiffnessTime& time) override { time_ = time; }
  /// What is frozen of a pair: k in the place of `fixed`, m in that of `per_gap_sq`.
  void fill_parts(const StiffnessBatch& rows, KappaParts* parts) const override {
    for (std::size_t r = 0; r < rows.n; ++r) {
      const ColumnMajor<double> hessian{rows.hessian ? rows.hessian + 144 * r : nullptr, 12};
      const auto sums = contact_sums(rows.n_free[r], rows.weight + 4 * r, rows.normal + 3 * r,
                                     rows.mass + 4 * r, hessian, rows.hessian != nullptr);
      parts[r] = {sums.elastic / sums.w_sq, sums.mass / sums.w_sq};
    }
  }
  void eval(const KappaParts& frozen, double d_hat, std::size_t n, const double* d, double* kappa,
            double* slope) const override {
    made_.in_gap(frozen.per_gap_sq, frozen.fixed, time_.dt, time_.c, d_hat, n, d, kappa, slope);
    for (std::size_t i = 0; i < n; ++i) kappa[i] *= multiplier_, slope[i] *= multiplier_;
  }

 private:
  FormulaPolicy made_;
  std::unique_ptr<StiffnessPolicy> of_plugin_;
  double multiplier_;
  bool derived_;
  StiffnessTime time_;
};

}  // namespace bb
