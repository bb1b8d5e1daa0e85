#include "experiments/run/run_summary.hpp"

namespace bb {

void summarize_steps(const std::vector<SolverCounter>& counters, RunRecord& record) {
  Summary& summary = record.summary;
  summary.saddle_curvature_N_per_m = Number::missing("none_found");
  std::vector<double> newton, contacts, gaps, errors;
  for (const StepRecord& step : record.steps) {
    ++summary.steps;
    summary.steps_capped += step.status == StepStatus::iteration_cap;
    summary.newton_iterations += step.newton_iterations;
    summary += step;
    summary.solver.add(counters, step.solver);
    newton.push_back(step.newton_iterations);
    contacts.push_back(static_cast<double>(step.contacts.total()));
    if (step.gap_min_rel.finite()) gaps.push_back(step.gap_min_rel.value);
    keep_smaller(summary.gap_min_m, step.gap_min_m);
    keep_smaller(summary.gap_min_ulps, step.gap_min_ulps);
    keep_smaller(summary.dt_min_s, step.dt_s);
    summary.retries += step.retries;
    summary.redone_audited += step.redone_audited;
    summary.audited_queries += step.audited_queries;
    if (step.status == StepStatus::converged) ++summary.end_proofs[std::string(to_string(step.end_proof))];
    if (step.end_error_tolerances.finite()) errors.push_back(step.end_error_tolerances.value);
    keep_smaller(summary.saddle_curvature_N_per_m, step.saddle_curvature_N_per_m);
    keep_smaller(summary.gap_min_iterates_m, step.gap_min_iterates_m);
    keep_smaller(summary.gap_min_iterates_rel, step.gap_min_iterates_rel);
    keep_larger(summary.max_stretch, step.max_stretch);
    keep_larger(summary.contact_load_max_N, step.contact_load_max_N);
    summary.broken_stitches = std::max(summary.broken_stitches, step.broken_stitches);
    keep_larger(summary.limit_load_max_N_per_m, step.limit_load_max_N_per_m);
    keep_larger(summary.solid_limit_load_max_Pa, step.solid_limit_load_max_Pa);
  }
  summary.newton_per_step = summarize(newton);
  summary.contacts = summarize(contacts);
  summary.gap_min_rel = summarize(gaps);
  summary.end_error_tolerances = summarize(errors);
}

}  // namespace bb
