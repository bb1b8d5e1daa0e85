// One time step with a barrier-augmented Lagrangian (Guo et al. 2024, Barrier-Augmented Lagrangian for GPU-based Elastodynamic
// Contact): Newton of line_search with its step bound, and after every iterate that was accepted a dual update: pairs
// that are nearer than a hundredth of d_hat get a multiplier beside the barrier, which opens their gaps by a force that has
// no curvature, and all barriers become stiffer, until no gap is that small (core/terms/barrier_multipliers.hpp, which reports what
// differs). The set of those pairs and their multipliers are fixed while E is minimised between two updates. Otherwise
// than there besides: matrices are factorised or solved as /linear_solver says, with the choice of Hessians that line_search has,
// and steps end by its rule.
#include "core/math/error.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/line_search.hpp"
#include "core/newton/newton_system.hpp"
#include "core/terms/contact.hpp"

namespace bb {
namespace {

class AlBarrier final : public StepSolver {
 public:
  explicit AlBarrier(const StepSolverOptions& options)
      : newton_(
            make_line_search(options, {.cap_fraction = number(options.parameters, "cap_fraction"),
                                       .after_motion = [](StepSystem& system) { return update(system); }})) {}
  std::string_view name() const override { return "al_barrier"; }

  void require(StepSystem& system) const override { require_on_host(system, name()); }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = newton_->advance(system, task, used, observer);
    const ContactTerm* contact = system.on_host().constraints().contact();
    const BarrierMultiplierCounts counts = contact ? contact->beside() : BarrierMultiplierCounts();
    step.solver.values = {{"al_barrier_updates", counts.updates},
                          {"al_barrier_releases", counts.releases},
                          {"al_barrier_pairs", counts.pairs_most},
                          {"al_barrier_force_N", counts.force_N},
                          {"al_barrier_stiffening", counts.stiffening},
                          {"al_barrier_feasibility_trials", step.solver.values.at("feasibility_trials")},
                          {"al_barrier_secants", step.solver.values.at("secants")}};
    return step;
  }

 private:
  static bool update(StepSystem& system) {
    ContactTerm* contact = system.on_host().constraints().contact();
    return contact && contact->update_beside();
  }

  std::unique_ptr<StepSolver> newton_;
};

/// Errors: ConfigError for a release that is not above near: a gap that drops multipliers would give one.
void set_barrier_multipliers(const StepSolverOptions& options, TermOptions& terms) {
  const auto of = [&](const char* name) { return number(options.parameters, name); };
  if (of("al_barrier_release") <= of("al_barrier_near")) {
    throw ConfigError("/step_solver/al_barrier_release", std::to_string(of("al_barrier_release")),
                      "a number above al_barrier_near = " + std::to_string(of("al_barrier_near")));
  }
  terms.barrier_multipliers = BarrierMultiplierRules{.near = of("al_barrier_near"),
                                                     .release = of("al_barrier_release"),
                                                     .growth = of("al_barrier_growth"),
                                                     .growth_most = of("al_barrier_growth_most")};
}

}  // namespace

StepSolverEntry step_solver_al_barrier() {
  StepSolverEntry entry;
  entry.guarantee =
      "no surface passes through another and no strain reaches its limit, in the motion of any iteration; a "
      "step that does not converge ends the run";
  entry.parameters = {
      {"armijo", open_high(open_low(number_in(0, 0.5, "1"))), 1e-4, "sufficient decrease"},
      {"cap_fraction", open_low(number_in(0, 1, "1")), 0.8,
       "part of a binding contact or strain bound that is taken; 1 goes to the stop level"},
      {"al_barrier_near", open_high(open_low(number_in(0, 1, "1"))), 1e-2,
       "al_barrier: gap in d_hat below which a pair gets a multiplier (Guo et al. 2024)"},
      {"al_barrier_release", open_low(number_in(0, 1, "1")), 0.1,
       "al_barrier: smallest gap in d_hat from which no pair has a multiplier any more; above "
       "al_barrier_near"},
      {"al_barrier_growth", number_in(1, 1e6, "1"), 1.2,
       "al_barrier: what the stiffness grows by with an update (Guo et al. 2024)"},
      {"al_barrier_growth_most", number_in(1, 1e12, "1"), 100.0,
       "al_barrier: largest stiffness in the policy's, after which multipliers are kept (Guo et al. 2024)"},
  };
  entry.stated_always = false;
  entry.counters = {
      {"al_barrier_updates", "al_barrier: updates of multipliers and stiffness", OverSteps::sum},
      {"al_barrier_releases", "al_barrier: times that all multipliers were dropped", OverSteps::sum},
      {"al_barrier_pairs", "al_barrier: most pairs with a multiplier", OverSteps::largest},
      {"al_barrier_force_N", "al_barrier: largest multiplier at the end of a step", OverSteps::largest},
      {"al_barrier_stiffening", "al_barrier: stiffness at the end of a step in the policy's",
       OverSteps::largest},
      {"al_barrier_feasibility_trials",
       "al_barrier: those of line_search_trials that feasibility alone judged, short of a pose",
       OverSteps::sum},
      {"al_barrier_secants",
       "al_barrier: iterations with a share of the secant of friction (/friction/hessian)", OverSteps::sum},
  };
  entry.needs.multipliers = true;
  entry.set_terms = set_barrier_multipliers;
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<AlBarrier>(options);
  };
  return entry;
}

}  // namespace bb
