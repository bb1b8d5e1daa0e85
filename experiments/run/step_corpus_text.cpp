// The record and the table of the hard time steps.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "experiments/run/step_corpus.hpp"

namespace bb {
namespace {

using json = nlohmann::ordered_json;

json json_of(const CorpusTrial& t) {
  json causes = json::object();
  for (const IterationCause cause : all_iteration_causes)
    causes[std::string(to_string(cause))] = t.causes[static_cast<std::size_t>(cause)];
  json out = {{"step_solver", t.step_solver},
              {"hessian", t.hessian.empty() ? json() : json(t.hessian)},
              {"friction_hessian", t.exact_friction ? json("exact") : json()}};
  if (!t.refused.empty()) {
    out["refused"] = t.refused;
    return out;
  }
  out["status"] = to_string(t.status);
  out["has_memory"] = t.has_memory;
  out["minimum"] = t.minimum.empty() ? json() : json(t.minimum);
  out["error_m"] = json_of(t.error_m);
  out["iterations"] = t.iterations;
  out["iterations_to_tolerance"] = t.iterations_to_tolerance ? json(*t.iterations_to_tolerance) : json();
  out["linear_solves"] = t.work.linear_solves;
  out["hessian_fallbacks"] = t.work.hessian_fallbacks;
  out["factorizations"] = t.work.factorizations + t.work.end_check_factorizations;
  out["linear_iterations"] = t.work.linear_iterations + t.work.end_check_iterations;
  out["seconds"] = t.seconds;
  out["causes"] = std::move(causes);
  out["regularised"] = t.regularised;
  out["gap_min_rel"] = json_of(t.gap_min_rel);
  out["gap_rel_p05"] = json_of(t.gap_rel_p05);
  out["gap_rel_median"] = json_of(t.gap_rel_median);
  out["gap_rel_p95"] = json_of(t.gap_rel_p95);
  out["state_hash"] = t.state_hash;
  return out;
}

json json_of(const CorpusState& s) {
  json out = {{"name", s.name},
              {"hard_for", s.hard_for},
              {"split", s.split},
              {"formulation", s.formulation},
              {"step_solver", s.step_solver},
              {"linear_solver", s.linear_solver},
              {"step", s.step},
              {"vertices", s.vertices}};
  if (!s.refused.empty()) {
    out["refused"] = s.refused;
    return out;
  }
  json trials = json::array();
  for (const CorpusTrial& trial : s.trials) trials.push_back(json_of(trial));
  out["contacts"] = s.has_reference ? json(s.contacts) : json();
  out["tolerance_m"] = s.tolerance_m;
  out["reference_status"] = s.has_reference ? json(to_string(s.reference)) : json();
  out["reference_iterations"] = s.has_reference ? json(s.reference_iterations) : json();
  out["seconds"] = s.seconds;
  out["trials"] = std::move(trials);
  return out;
}

/// "2 contact, 1 full": those that there are.
std::string causes_text(const CorpusTrial& t) {
  std::string out;
  for (const IterationCause cause : all_iteration_causes) {
    const int n = t.causes[static_cast<std::size_t>(cause)];
    if (n > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", n, to_string(cause));
  }
  return out;
}

}  // namespace

std::string corpus_json(const std::vector<CorpusState>& states, const RunOptions& options) {
  const Provenance provenance = collect_provenance(options.argv, 0);
  json all = json::array();
  for (const CorpusState& state : states) all.push_back(json_of(state));
  const json out = {{"schema", "barrierbench.step_corpus/1"},
                    {"git_commit", provenance.git_commit},
                    {"cpu", collect_machine().cpu_model},
                    {"states", std::move(all)}};
  return out.dump(1) + "\n";
}

std::string corpus_table(const CorpusState& state) {
  if (!state.refused.empty())
    return fmt::format("{}, step {}: refused: {}\n", state.name, state.step, state.refused);
  const std::string contacts =
      state.has_reference ? fmt::format("{} contacts, ", state.contacts) : std::string();
  std::string out = fmt::format("{}, step {}, {} vertices, {}{}: {}\n", state.name, state.step,
                                state.vertices, contacts, state.linear_solver, state.hard_for);
  out += fmt::format("  {:<20} {:<21} {:>10} {:>6} {:>6} {:>8} {:>8} {:>10} {:>3}  {:<18} {}\n",
                     "step solver", "hessian", "iterations", "to tol", "solves", "factors", "products",
                     "error", "min", "status", "causes");
  for (const CorpusTrial& t : state.trials) {
    if (!t.refused.empty()) {
      out += fmt::format("  {:<20} refused: {}\n", t.step_solver, t.refused);
      continue;
    }
    out +=
        fmt::format("  {:<20} {:<21} {:>10} {:>6} {:>6} {:>8} {:>8} {:>10} {:>3}  {:<18} {}\n", t.step_solver,
                    t.exact_friction ? t.hessian + ", exact friction" : t.hessian, t.iterations,
                    t.iterations_to_tolerance ? std::to_string(*t.iterations_to_tolerance) : "-",
                    t.work.linear_solves, t.work.factorizations + t.work.end_check_factorizations,
                    t.work.linear_iterations + t.work.end_check_iterations,
                    t.error_m.finite() ? fmt::format("{:.3g}", t.error_m.value / state.tolerance_m) : "-",
                    t.minimum.empty() ? "-" : t.minimum, to_string(t.status), causes_text(t));
  }
  return out;
}

}  // namespace bb
