// One time step with contact as inequalities that multipliers hold, as the cloth example of jaxls has it ("Cloth draping" of its
// documentation): E with an augmented Lagrangian in the place of the barrier is minimised, multipliers and penalties are
// updated, and so on until contacts are neither violated nor push where they are open (core/terms/contact_multipliers.hpp).
// Nothing bounds a motion, and no test of a state requires gaps. Otherwise than there, each minimum is found by the Newton of
// line_search, to its tolerance or to the gradient al_inner_tolerance_N, and theirs by Levenberg and Marquardt with conjugate
// gradients in float. max_iterations is that of all Newton iterations of a step together.
#include <algorithm>

#include "core/newton/iteration.hpp"
#include "core/newton/line_search.hpp"
#include "core/newton/newton_system.hpp"
#include "core/terms/contact.hpp"

namespace bb {
namespace {

class AugmentedLagrangian final : public StepSolver {
 public:
  explicit AugmentedLagrangian(const StepSolverOptions& options)
      : newton_(make_line_search(
            options,
            {.bounded = false, .gradient_tolerance = number(options.parameters, "al_inner_tolerance_N")})) {}
  std::string_view name() const override { return "augmented_lagrangian"; }
  void require(StepSystem& system) const override { require_on_host(system, name()); }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = newton_->advance(system, task, used, observer);
    StepNumbers end;
    system.view().report_end(end);
    const ContactTerm* contact = system.on_host().constraints().contact();
    const auto or_zero = [](const Number& number) { return number.finite() ? number.value : 0.0; };
    step.solver.values = {{"al_updates", contact ? contact->multiplier_updates() : 0},
                          {"al_violation_m", std::max(0.0, -or_zero(end.gap_min_m))},
                          {"al_penalty_N_per_m", or_zero(end.kappa_max_N_per_m)},
                          {"al_feasibility_trials", step.solver.values.at("feasibility_trials")},
                          {"al_secants", step.solver.values.at("secants")}};
    return step;
  }

 private:
  std::unique_ptr<StepSolver> newton_;
};

/// m. What is violated at the start of a step was within the tolerance of the step before, so that less than 1 m is.
double tolerance_of(const ParameterMap& complete) {
  return std::max(number(complete, "al_tolerance_m"), number(complete, "al_tolerance_relative"));
}

void set_contact_multipliers(const StepSolverOptions& options, TermOptions& terms) {
  const auto of = [&](const char* name) { return number(options.parameters, name); };
  terms.multipliers = MultiplierRules{.initial = of("al_penalty_initial_N_per_m"),
                                      .factor = of("al_penalty_factor"),
                                      .largest = of("al_penalty_largest_N_per_m"),
                                      .reduction = of("al_reduction"),
                                      .tolerance_m = tolerance_of(options.parameters)};
}

}  // namespace

StepSolverEntry step_solver_augmented_lagrangian() {
  StepSolverEntry entry;
  entry.guarantee =
      "none against passing through; at the end of a step that converges no contact is violated by more than "
      "al_tolerance_m, or al_tolerance_relative of 1 m where that is more, where its gap has a sign";
  entry.parameters = {
      {"armijo", open_high(open_low(number_in(0, 0.5, "1"))), 1e-4, "sufficient decrease"},
      {"al_tolerance_m", positive("m"), 1e-6,
       "augmented_lagrangian: largest violation of a contact, and gap (m) or force (N), whichever is less, "
       "at the end of a step"},
      {"al_tolerance_relative", open_high(number_in(0, 1, "1")), 0.0,
       "augmented_lagrangian: the same as a part of what was violated at the start of the step, which counts "
       "as 1 m where it is less, as in jaxls; the larger of the two tolerances holds"},
      {"al_inner_tolerance_N", non_negative("N"), 0.0,
       "augmented_lagrangian: multipliers are updated, and a step may end, once the norm of the gradient was "
       "below it before a motion, or the step is within tol_velocity; 0: within tol_velocity alone"},
      {"al_penalty_initial_N_per_m", non_negative("N/m"), 0.0,
       "augmented_lagrangian: penalty of a pair that is new in a step; 0: 10 max(1, 2 E), E in J of inertia "
       "and elasticity at its start"},
      {"al_penalty_factor", open_low(number_in(1, 1e6, "1")), 4.0,
       "augmented_lagrangian: what a penalty grows by where a violation does not shrink"},
      {"al_penalty_largest_N_per_m", positive("N/m"), 1e7, "augmented_lagrangian: largest penalty"},
      {"al_reduction", open_high(open_low(number_in(0, 1, "1"))), 0.5,
       "augmented_lagrangian: part of a violation that may be left from update to update before its penalty "
       "grows"},
  };
  entry.stated_always = false;
  entry.counters = {
      {"al_updates", "augmented_lagrangian: updates of the multipliers", OverSteps::sum},
      {"al_violation_m", "augmented_lagrangian: largest -d of a contact at the end of a step",
       OverSteps::largest},
      {"al_penalty_N_per_m", "augmented_lagrangian: largest penalty of a contact at the end of a step",
       OverSteps::largest},
      {"al_feasibility_trials",
       "augmented_lagrangian: those of line_search_trials that energies did not judge, short of a pose",
       OverSteps::sum},
      {"al_secants",
       "augmented_lagrangian: iterations with a share of the secant of friction (/friction/hessian)",
       OverSteps::sum},
  };
  entry.needs.step_bound = false;
  entry.needs.overlap = entry.needs.multipliers = true;
  entry.settings.velocity_of_step = true;
  entry.set_terms = set_contact_multipliers;
  entry.promised_overlap = tolerance_of;
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<AugmentedLagrangian>(options);
  };
  return entry;
}

}  // namespace bb
