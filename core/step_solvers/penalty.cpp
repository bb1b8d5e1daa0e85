// One time step with contact as a penalty, as many engines have it: kappa b of a bounded shape, which goes on beyond contact
// by its formula, in implicit steps: Newton with a line search on E, without a step bound and without a test of gaps. With
// the shape quadratic, b = (d_hat - d)^2, that is a spring of the stiffness k = 2 kappa (N/m) on every gap below d_hat. It
// pushes apart what overlaps where a gap has a sign: at surfaces with an offset and at obstacles. The gap of surfaces
// without thickness has none: what has come through a surface is pushed on, and only the audit reports that it did.
#include <algorithm>

#include "core/newton/line_search.hpp"

namespace bb {
namespace {

class Penalty final : public StepSolver {
 public:
  explicit Penalty(const StepSolverOptions& options)
      : newton_(make_line_search(options, {.bounded = false})) {}
  std::string_view name() const override { return "penalty"; }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = newton_->advance(system, task, used, observer);
    StepNumbers end;
    system.view().report_end(end);
    const double overlap = end.gap_min_m.finite() ? std::max(0.0, -end.gap_min_m.value) : 0;
    const auto within = [](const ContactLoad& contact) { return contact.gap_rel <= 0; };
    const auto overlapping = std::count_if(end.contact_loads.begin(), end.contact_loads.end(), within);
    step.solver.values = {{"penalty_overlap_m", overlap},
                          {"penalty_overlaps", static_cast<double>(overlapping)},
                          {"penalty_feasibility_trials", step.solver.values.at("feasibility_trials")},
                          {"penalty_secants", step.solver.values.at("secants")}};
    return step;
  }

 private:
  std::unique_ptr<StepSolver> newton_;
};

}  // namespace

StepSolverEntry step_solver_penalty() {
  StepSolverEntry entry;
  entry.guarantee =
      "none against passing through: surfaces overlap where a load is above k d_hat, and what moves by more "
      "than d_hat in a step may come out behind; a step that converges ends in a minimum of E";
  entry.parameters = {{"armijo", open_high(open_low(number_in(0, 0.5, "1"))), 1e-4, "sufficient decrease"}};
  entry.counters = {
      {"penalty_overlap_m", "penalty: largest -d of a contact at the end of a step", OverSteps::largest},
      {"penalty_overlaps", "penalty: contacts with d <= 0 at the end of a step, without mollified ones",
       OverSteps::largest},
      {"penalty_feasibility_trials",
       "penalty: those of line_search_trials that energies did not judge, short of a pose", OverSteps::sum},
      {"penalty_secants", "penalty: iterations with a share of the secant of friction (/friction/hessian)",
       OverSteps::sum},
  };
  entry.needs.step_bound = false;
  entry.needs.overlap = true;
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<Penalty>(options);
  };
  return entry;
}

}  // namespace bb
