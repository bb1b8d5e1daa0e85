// Stiffness policy `formula`: kappa of every contact as a formula that the config gives.
#pragma once

#include <memory>
#include <string>

#include "barriers/formulas.hpp"
#include "core/barrier/stiffness_policy.hpp"

namespace bb {

/// Compiled as a plugin (barriers/formulas.hpp). kappa is a number of the iterate or of the step: no derivative of it is
/// in the curvature, and no potential is derived.
struct Formula {
  std::string formula;
  Refresh refresh = Refresh::per_iteration;

  template <class List>
  static void describe(List& list) {
    list.text("formula", &Formula::formula, most_formula_bytes,
              "kappa in N/m of m and k (w^T M w and w^T H w over w^T w of the contact, kg and N/m), h (s), c "
              "(of the inertia M/(c h^2)), d and d_hat (m): m/(c*h^2) + k");
    list.refresh(&Formula::refresh);
  }
  template <class Refuse>
  void check(Refuse& refuse) const {
    if (formula.empty()) return refuse("formula", "nothing", "a formula such as m/(c*h^2) + k");
    try {
      require_policy_formula(formula, "");
    } catch (const ConfigError& error) {
      for (const Violation& wrong : error.violations()) refuse("formula", wrong.found, wrong.allowed);
    }
  }
  class Policy;
};

class Formula::Policy final : public StiffnessPolicy {
 public:
  Policy(const Formula& values, double multiplier)
      : of_plugin_(require_policy_formula(values.formula, "stiffness_policy/formula")
                       .policy.make(values.refresh, multiplier)) {}
  std::string_view name() const override { return "formula"; }
  Refresh refresh() const override { return of_plugin_->refresh(); }
  bool needs_hessian() const override { return of_plugin_->needs_hessian(); }
  void fill(const StiffnessBatch& rows, double* kappa) const override { of_plugin_->fill(rows, kappa); }

 private:
  std::unique_ptr<StiffnessPolicy> of_plugin_;
};

}  // namespace bb
