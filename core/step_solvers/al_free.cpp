// One time step without a barrier (Zheng, Luo, Li 2026, Robust and Efficient Penetration-Free Elastodynamics without Barriers). Read
// core/terms/linear_contact.hpp for what contact is there. A step has outer iterations:
//
//   1 gaps of all constraints are linearised at the anchor
//   2 Newton with clamped matrices and a line search on E from the iterate, until a direction was taken whole, at most
//     al_free_inner times: no step bound, surfaces of the iterate may overlap
//   3 multipliers and weights of the constraints are updated there
//   4 ACCD from the anchor to the iterate: the anchor goes as far as nothing stops it, what did becomes a constraint at once
//   5 beta, the part of the step's end that the start and the first iterates still are, shrinks by 1 - alpha from the
//     iteration al_free_first on; the step is over below al_free_beta, as published, and with al_free_settled > 0 when
//     besides the anchor is the iterate, and direction and multipliers change by less than that many tolerances. Otherwise than
//     published it also goes on while a constraint that has a force opens its gap faster than al_free_recovery_m_per_s: multipliers
//     of an impact that are left over would throw off what they have stopped.
//
// The step ends in the anchor. max_iterations is that of all Newton iterations of a step together.
#include <algorithm>

#include "core/math/error.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/newton_system.hpp"
#include "core/newton/step_solver.hpp"
#include "core/terms/linear_contact.hpp"

namespace bb {
namespace {

constexpr double shortest_trial = 1e-10;  // of the line search, which takes what it tried last

class AlFree final : public StepSolver {
 public:
  explicit AlFree(const StepSolverOptions& options)
      : options_(options),
        beta_end_(number(options.parameters, "al_free_beta")),
        settled_(number(options.parameters, "al_free_settled")),
        first_(integer(options.parameters, "al_free_first")),
        inner_(integer(options.parameters, "al_free_inner")),
        share_(number(options.parameters, "al_free_penalty_share")),
        recovery_(number(options.parameters, "al_free_recovery_m_per_s")) {}
  std::string_view name() const override { return "al_free"; }

  void require(StepSystem& system) const override {
    require_on_host(system, name());
    for (const auto& term : system.on_host().diagnosis().terms()) {
      const std::string_view of = term->name();
      if (of == "strain_limit" || of == "friction" || of == "restitution")
        throw ConfigError("/step_solver/name", "al_free with the term " + std::string(of),
                          "a scene without it, or another step solver");
    }
  }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = start_step(system, task, used);
    contact_ = system.on_host().constraints().linear_contact();
    counts_ = {};
    double beta = 1;
    for (int outer = 1; step.status == StepStatus::iteration_cap; ++outer) {
      const double alpha = iterate(system, step, task, observer);
      if (step.status != StepStatus::iteration_cap) break;
      if (outer >= first_) beta *= 1 - alpha;
      counts_["al_free_outer"] = outer;
      const bool enough = settled_ == 0 || (alpha == 1 && moved_ <= settled_ * tolerance(task));
      const bool throws = contact_ && contact_->opening_speed() > recovery_;
      if (beta <= beta_end_ && outer >= first_ && enough && !throws) step.status = StepStatus::converged;
      if (step.newton_iterations >= options_.max_iterations) break;
    }
    if (contact_ && contact_->anchor() != system.view().x()) {
      // the history's x has no motion back: what is committed is the anchor, whose way was watched
      system.on_host().go_to(contact_->anchor());
    }
    if (step.status == StepStatus::iteration_cap) step.detail = "the anchor did not come to the iterate";
    finish_counts(step, beta);
    return step;
  }

 private:
  double tolerance(const StepTask& task) const { return options_.tol_velocity * task.dt; }

  // One outer iteration; returns the part of the way to the iterate that the anchor went.
  double iterate(StepSystem& system, StepReport& step, const StepTask& task, StepObserver& observer) {
    double first_dx = 0;
    const Positions before = contact_ ? contact_->anchor() : task.history->x;
    for (int inner = 1;; ++inner) {
      IterationReport report = begin_iteration(system, task.step, step.newton_iterations);
      if (step.newton_iterations == 0) set_penalty(system);
      find_direction(system, report, observer);
      if (const auto failed = direction_failure(report, false)) {
        finish_iteration(system, step, report, observer);
        fail_step(system, step, *failed, report);
        return 0;
      }
      if (inner == 1) first_dx = report.dx_inf_m;
      const bool whole = search(system, report);
      const bool over = whole || inner == inner_ || step.newton_iterations + 1 >= options_.max_iterations;
      const double alpha = over ? move_anchor(system, report, first_dx) : 0;
      finish_iteration(system, step, report, observer);
      if (!over) continue;
      // The motion is shown after its iteration, as by every step solver.
      if (alpha > 0 && observer.watches_motions())
        observer.on_motion(before, contact_ ? contact_->anchor() : Positions(system.view().x()), task.step);
      return alpha;
    }
  }

  // The matrix is that of the start of the step, with the constraints that there are; theirs are left out.
  void set_penalty(StepSystem& system) {
    if (!contact_) return;
    contact_->set_penalty(share_ * system.on_host().constraints().stiffest());
    system.assemble();
  }

  // Whether the first trial was taken: as published, what is tried last is.
  bool search(StepSystem& system, IterationReport& report) {
    system.prepare_motion(MotionEnd::on_target, false);
    for (double alpha = 1;; alpha /= 2) {
      ++report.line_search_trials;
      const auto change = system.try_motion(alpha);
      const bool falls = change && (change->change <= 0 || within_rounding(*change));
      if (!falls && alpha > shortest_trial) continue;
      if (!change) return true;
      report.alpha = alpha;
      report.energy_change_J = change->change;
      system.accept();
      return alpha == 1;
    }
  }

  double move_anchor(StepSystem& system, IterationReport& report, double dx) {
    if (!contact_) {
      moved_ = dx;
      return 1;
    }
    const PositionsView x = system.view().x();
    const double change = contact_->update(x);
    const LinearContact::Advance done = contact_->advance(x, system.clock());
    report.bound = done.bound;
    report.alpha_ccd = done.bound.alpha;
    moved_ = std::max({dx, change, done.time < 1 ? 1.0 : 0.0});
    counts_["al_free_bounds"] += done.hits > 0;
    counts_["al_free_bounds_known"] += done.hits > 0 && done.known;
    counts_["al_free_admitted"] += static_cast<double>(done.admitted);
    counts_["al_free_dropped"] += static_cast<double>(done.dropped);
    return done.time;
  }

  void finish_counts(StepReport& step, double beta) {
    std::map<std::string, double>& values = step.solver.values;
    for (const char* name :
         {"al_free_outer", "al_free_bounds", "al_free_bounds_known", "al_free_admitted", "al_free_dropped"})
      values[name] = counts_[name];
    values["al_free_beta"] = beta;
    values["al_free_constraints"] = contact_ ? static_cast<double>(contact_->n_constraints()) : 0;
    values["al_free_penalty_N_per_m"] = contact_ ? contact_->penalty() : 0;
    values["al_free_force_N"] = contact_ ? contact_->largest_force() : 0;
    values["al_free_violation_m"] = contact_ ? contact_->violation() : 0;
    values["al_free_adaptations"] = contact_ ? contact_->adaptations() : 0;
  }

  StepSolverOptions options_;
  double beta_end_, settled_;
  int first_, inner_;
  double share_, recovery_;
  LinearContact* contact_ = nullptr;  // of the step in progress
  double moved_ = 0;                  // m, by direction and multipliers of the last outer iteration
  std::map<std::string, double> counts_;
};

std::vector<SolverCounter> al_free_counters() {
  const auto of = [](const char* name, const char* says, OverSteps over) {
    return SolverCounter{name, std::string("al_free: ") + says, over};
  };
  return {
      of("al_free_outer", "outer iterations: a linearisation, and an advance of the anchor", OverSteps::sum),
      of("al_free_bounds", "advances that a contact stopped", OverSteps::sum),
      of("al_free_bounds_known", "those of al_free_bounds whose first contact was a constraint already",
         OverSteps::sum),
      of("al_free_admitted", "pairs that became constraints", OverSteps::sum),
      of("al_free_dropped", "constraints that went since they were not active for long", OverSteps::sum),
      of("al_free_beta", "part of the end that start and first iterates are", OverSteps::largest),
      of("al_free_constraints", "constraints at the end of a step", OverSteps::largest),
      of("al_free_penalty_N_per_m", "penalty of a step", OverSteps::largest),
      of("al_free_force_N", "largest multiplier at the end of a step", OverSteps::largest),
      of("al_free_violation_m",
         "largest part of the standoff that a gap with a force lacks at the end of a step",
         OverSteps::largest),
      of("al_free_adaptations", "times that a stall doubled the penalty and halved the standoff",
         OverSteps::sum),
  };
}

std::vector<Parameter> al_free_parameters() {
  return {
      {"al_free_standoff", open_low(number_in(0, 1, "1")), 0.1,
       "al_free: gap that a constraint requires, in d_hat of its pair; that of /matching/theta is comparable "
       "with barriers"},
      {"al_free_recovery_m_per_s", positive("m/s"), 0.01,
       "al_free: speed with which a gap below its standoff opens at most, and with which a constraint that "
       "carries a force may open "
       "at the end of a step; 1e6: as published, where contact adds energy as dt falls"},
      {"al_free_penalty_N_per_m", non_negative("N/m"), 0.0,
       "al_free: penalty of all constraints; 0: al_free_penalty_share of the largest diagonal entry of the "
       "matrix without "
       "contact at the start of a step"},
      {"al_free_penalty_share", open_low(number_in(0, 1e6, "1")), 0.1,
       "al_free: see there (Zheng et al. 2026)"},
      {"al_free_beta", open_high(open_low(number_in(0, 1, "1"))), 1e-3,
       "al_free: part of the start and of the first iterates in the end of a step, below which it is over "
       "(Zheng et al. 2026)"},
      {"al_free_first", count(1, 1000), 6,
       "al_free: outer iterations that count as first ones: 2, with cloth 6 (Zheng et al. 2026)"},
      {"al_free_settled", non_negative("1"), 0.0,
       "al_free: a step also goes on until anchor and iterate are one and direction and multipliers change "
       "by less than that "
       "many tol_velocity h; 0: that is not required, as published"},
      {"al_free_inner", count(1, 1000), 8, "al_free: most Newton iterations for one linearisation"},
      {"al_free_decay", open_high(open_low(number_in(0, 1, "1"))), 0.9,
       "al_free: of the weight of a constraint that is not active, an update (Zheng et al. 2026)"},
      {"al_free_least_weight", open_high(open_low(number_in(0, 1, "1"))), 0.01,
       "al_free: weight below which a constraint goes (Zheng et al. 2026)"},
      {"al_free_advance", open_high(open_low(number_in(0, 1, "1"))), 0.9,
       "al_free: part of the way to the first contact that the anchor goes"},
  };
}

}  // namespace

StepSolverEntry step_solver_al_free() {
  StepSolverEntry entry;
  entry.guarantee =
      "no surface passes through another, in the motion of any state that a step may end in; gaps keep their "
      "standoff as far as multipliers have converged, and how far an end is from the solution is computed "
      "only "
      "with "
      "al_free_settled";
  entry.parameters = al_free_parameters();
  entry.stated_always = false;
  entry.counters = al_free_counters();
  entry.needs.minimum = false;
  entry.needs.multipliers = true;
  entry.asked_to_converge = false;
  entry.has_forces = false;
  entry.settings.unmoved = entry.settings.velocity_of_step = true;
  entry.set_terms = [](const StepSolverOptions& options, TermOptions& terms) {
    const auto of = [&](const char* name) { return number(options.parameters, name); };
    LinearContactRules rules;
    rules.standoff = of("al_free_standoff");
    rules.penalty = of("al_free_penalty_N_per_m");
    rules.recovery_speed = of("al_free_recovery_m_per_s");
    rules.decay = of("al_free_decay");
    rules.least_weight = of("al_free_least_weight");
    rules.advance = of("al_free_advance");
    terms.linear_contact = rules;
  };
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<AlFree>(options);
  };
  return entry;
}

}  // namespace bb
