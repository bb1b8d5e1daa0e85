#include "experiments/run/step_record.hpp"

#include <algorithm>
#include <limits>

#include "core/terms/contact.hpp"

namespace bb {
namespace {

// kappa and loads of the rows that the step ended with.
void fill_contact(const ContactState& state, const StepReport& report, StepRecord& step) {
  double kappa_min = std::numeric_limits<double>::infinity(), kappa_max = 0, load = 0;
  const auto scan = [&](const auto& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      kappa_min = std::min(kappa_min, rows.kappa[r]);
      kappa_max = std::max(kappa_max, rows.kappa[r]);
    }
  };
  state.for_each_table(scan);
  for (std::size_t r = 0; r < state.rows.size(); ++r) {  // mollified rows carry e(x) times as much: left out
    load -= state.rows.multiplicity[r] * state.rows.kappa[r] * state.rows.db[r];
  }
  const bool touching = report.contacts.total() > 0;
  const auto value = [touching](double x) { return touching ? Number(x) : Number::missing("no_contacts"); };
  step.kappa_min_N_per_m = value(kappa_min);
  step.kappa_max_N_per_m = value(kappa_max);
  step.contact_load_max_N = value(report.force_max);
  step.contact_load_sum_N = value(load);
}

void fill_energies(const NewtonSystem& system, const StepReport& report, StepRecord& step) {
  const Scene& scene = system.scene();
  step.kinetic_J = report.kinetic_energy;
  double gravity = 0;
  for (std::size_t i = 0; i < scene.mass.size(); ++i) {
    gravity -= scene.mass[i] * scene.gravity.dot(system.x().col(static_cast<Eigen::Index>(i)));
  }
  step.elastic_J = system.energy(TermGroup::elastic);
  step.limit_J = system.energy(TermGroup::limit);
  step.contact_J = system.energy(TermGroup::contact);
  step.gravity_J = gravity;
}

}  // namespace

StepRecord step_record(const NewtonSystem& system, const StepReport& report) {
  StepRecord step;
  step.step = report.step;
  step.t_s = report.t;
  step.status = std::string(to_string(report.status));
  step.stop_reason = report.detail;
  step.newton_iterations = report.iterations;
  step.linear_iterations = report.linear_iterations;
  step.linear_solves = report.iterations;
  step.factorizations = report.factorizations;
  step.analyses = report.analyses;
  step.line_search_trials = report.line_search_trials;
  step.rounding_accepts = report.accepted_by_rounding;
  step.ccd_queries = report.ccd_queries;
  step.ccd_probes = report.ccd_probes;
  step.ccd_capped = report.ccd_capped;
  step.ccd_zero = report.ccd_zero;
  step.contacts = report.contacts;
  step.toi_min = report.alpha_ccd_min;
  step.max_stretch = report.max_stretch > 0 ? Number(report.max_stretch - 1) : Number::missing("no_limit");
  step.limit_load_max_N_per_m =
      system.active(TermGroup::limit) ? Number(report.limit_tension_max) : Number::missing("no_limit");
  const bool converged = report.status == StepStatus::converged;
  const char* absent = converged                                                   ? "converged"
                       : report.kappa_unsettled + report.limit_kappa_unsettled > 0 ? "kappa_unsettled"
                                                                                   : "not_measured";
  const auto measured = [absent](const std::optional<double>& load) {
    return load ? Number(*load) : Number::missing(absent);
  };
  step.contact_overload = measured(report.overload);
  step.limit_overload = measured(report.limit_overload);
  fill_contact(contact_state(system.terms()), report, step);
  fill_energies(system, report, step);
  return step;
}

}  // namespace bb
