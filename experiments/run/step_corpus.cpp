#include "experiments/run/step_corpus.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "core/math/error.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/contact_gaps.hpp"
#include "experiments/run/thread_limit.hpp"

namespace bb {
namespace {

constexpr double same_minimum = 10;  // tolerances between an end and its minimum
constexpr const char* reference_solver = "line_search";

/// A step solver that ends a step by a rule of its own, with the setting that lets it go on to the tolerance.
struct Tightened {
  const char *solver, *parameter;
  double value;
};
constexpr Tightened tightened[] = {{"pncg", "pncg_epsilon", 1e-10}};

/// The config with another step solver, where what depends on it has its own default again. Errors: ConfigError for what the
/// solver cannot have.
RunConfig with_step_solver(const RunConfig& config, const std::string& name) {
  if (config.step_solver.name == name) return config;
  nlohmann::json document = resolved_document(config);
  document["step_solver"]["name"] = name;
  document["step_solver"].erase("saddle");
  document.erase("hessian");
  document["contact"].erase("hessian_mode");
  document["friction"].erase("hessian");
  for (const Tightened& each : tightened) {
    if (name == each.solver) document["step_solver"][each.parameter] = each.value;
  }
  RunConfig out = parse_config(document.dump(), config.source);
  out.linear_solver_reason = config.linear_solver_reason;
  return out;
}

/// The first violation without the name of the file.
std::string refusal_of(const ConfigError& error) {
  const Violation& first = error.violations().front();
  const std::string place = first.where.substr(first.where.find('#') + 1);
  return fmt::format("{}: found {}; allowed: {}", place, first.found, first.allowed);
}

double cap_fraction_of(const StepSolverConfig& solver) {
  const StepSolverEntry& entry = step_solvers().require(solver.name, "/step_solver/name");
  const bool has = find_named(entry.parameters, "cap_fraction") != nullptr;
  return has ? number(solver.parameters, "cap_fraction") : 1;
}

double apart(const Positions& a, const Positions& b) { return (a - b).cwiseAbs().maxCoeff(); }

/// The minima that trials of a state ended in, in the order of their letters.
class Minima {
 public:
  explicit Minima(double tolerance) : tolerance_(tolerance) {}
  void add(Positions x) { list_.push_back(std::move(x)); }
  bool empty() const { return list_.empty(); }
  /// That within ten tolerances of x, the nearest; list_.size() where none is.
  std::size_t nearest(const Positions& x) const {
    std::size_t out = list_.size();
    double least = same_minimum * tolerance_;
    for (std::size_t i = 0; i < list_.size(); ++i) {
      if (const double d = apart(x, list_[i]); d <= least) least = d, out = i;
    }
    return out;
  }
  std::size_t size() const { return list_.size(); }
  const Positions& at(std::size_t i) const { return list_[i]; }

 private:
  double tolerance_;
  std::vector<Positions> list_;
};

void count_causes(const TakenStep& taken, double cap_fraction, CorpusTrial& out) {
  for (const IterationReport& report : taken.iterations) {
    ++out.causes[static_cast<std::size_t>(cause_of(report, cap_fraction))];
    out.regularised += is_regularised(report);
    out.work += report;
  }
}

/// A step that is converged far from all known minima ends in another one, which the same trial shows at a thousandth of the
/// tolerance.
void find_minimum(const StepSetting& setting, const std::string& archive, const StepVariant& variant,
                  const TakenStep& taken, Minima& minima) {
  StepVariant fine = variant;
  fine.finer = reference_finer, fine.keeps_states = false;
  TakenStep end = take_step(setting, archive, fine);
  if (minima.nearest(end.end) < minima.size()) return;  // the trial had stopped too early
  if (end.report.status == StepStatus::converged &&
      apart(end.end, taken.end) <= same_minimum * taken.tolerance_m)
    minima.add(std::move(end.end));
}

void judge_end(const TakenStep& taken, const Minima& minima, CorpusTrial& out) {
  if (minima.empty()) return;
  const std::size_t found = minima.nearest(taken.end);
  const Positions& x = minima.at(found < minima.size() ? found : 0);
  if (found < minima.size()) out.minimum = minimum_name(found);
  out.error_m = apart(taken.end, x);
  for (std::size_t k = 0; k < taken.states.size() && !out.iterations_to_tolerance; ++k) {
    if (apart(taken.states[k], x) < taken.tolerance_m) out.iterations_to_tolerance = static_cast<int>(k) + 1;
  }
}

/// Of a step that converged; a step without load has none.
void find_gaps(const StepReport& report, CorpusTrial& out) {
  out.gap_min_rel = report.gap_min_rel;
  LogHistogram gaps;
  for (const ContactLoad& each : report.contact_loads) {
    if (each.load_N > 0) gaps.add(each.gap_rel, each.load_N);
  }
  if (report.status != StepStatus::converged || gaps.weight() == 0) return;
  out.gap_rel_p05 = gaps.quantile(0.05);
  out.gap_rel_median = gaps.quantile(0.5);
  out.gap_rel_p95 = gaps.quantile(0.95);
}

void take_trial(const StepState& state, Minima& minima, CorpusTrial& out) {
  const auto hessian = out.hessian.empty() ? std::nullopt : std::optional(step_hessian_of(out.hessian));
  RunConfig config = with_step_solver(state.config, out.step_solver);
  if (out.exact_friction) config.friction.hessian = FrictionHessian::exact;
  const StepSolverEntry& entry = step_solvers().require(out.step_solver, "/step_solver/name");
  check_step_solver_forms(config, state.scene);
  const StepSetting setting{config, state.scene, state.calibration, plan_of(config, state.scene)};
  if (out.exact_friction && !setting.plan.term("friction").needed)
    throw ConfigError("/friction/mu", "a state without friction",
                      "one above 0 for another matrix of friction");
  const StepVariant variant{hessian, 1, true};
  const TakenStep taken = take_step(setting, state.start.bytes, variant);
  const bool own_energy = entry.needs.multipliers;  // with multipliers another function is minimised
  if (!minima.empty() && !own_energy && entry.asked_to_converge &&
      taken.report.status == StepStatus::converged && minima.nearest(taken.end) == minima.size())
    find_minimum(setting, state.start.bytes, variant, taken, minima);
  out.status = taken.report.status;
  out.has_memory = taken.has_memory;
  out.iterations = static_cast<int>(taken.iterations.size());
  out.seconds = taken.seconds;
  out.state_hash = state_hash(taken.end);
  find_gaps(taken.report, out);
  count_causes(taken, cap_fraction_of(config.step_solver), out);
  judge_end(taken, minima, out);
}

/// line_search at a thousandth of the tolerance; its end is the minimum A where it converges. Errors: ConfigError for a
/// state that line_search cannot have.
void find_reference(const StepState& state, Minima& minima, CorpusState& out) {
  const RunConfig config = with_step_solver(state.config, reference_solver);
  const StepSetting setting{config, state.scene, state.calibration, plan_of(config, state.scene)};
  TakenStep fine = take_step(setting, state.start.bytes, {StepHessian::blend, reference_finer});
  out.reference = fine.report.status;
  out.reference_iterations = fine.report.newton_iterations;
  out.contacts = fine.report.contacts.total();
  if (out.reference == StepStatus::converged) minima.add(std::move(fine.end));
}

std::vector<CorpusTrial> all_trials() {
  std::vector<CorpusTrial> out;
  for (const StepHessian hessian : all_step_hessians) {
    out.emplace_back();
    out.back().step_solver = reference_solver;
    out.back().hessian = to_string(hessian);
  }
  CorpusTrial& exact = out.emplace_back();
  exact.step_solver = reference_solver;
  exact.hessian = to_string(StepHessian::blend);
  exact.exact_friction = true;
  for (const StepSolverEntry& entry : step_solvers()) {
    if (entry.name == reference_solver) continue;
    out.emplace_back();
    out.back().step_solver = entry.name;
  }
  return out;
}

/// Of the state alone.
CorpusState described(const StepState& state) {
  CorpusState out;
  out.name = state.name, out.hard_for = state.hard_for, out.split = state.split;
  out.formulation = label_of(state.config.formulation);
  out.step_solver = state.config.step_solver.name;
  out.linear_solver = state.config.linear_solver.name;
  out.step = state.start.step;
  out.vertices = state.scene.n_vertices();
  out.tolerance_m = state.config.step_solver.tol_velocity * state.config.time.dt;
  return out;
}

}  // namespace

std::string minimum_name(std::size_t place) {
  constexpr std::size_t letters = 26;
  std::string out;
  for (std::size_t n = place + 1; n > 0; n = (n - 1) / letters)
    out.insert(out.begin(), static_cast<char>('A' + (n - 1) % letters));
  return out;
}

std::string trial_name(const CorpusTrial& trial) {
  std::string out = trial.step_solver;
  if (!trial.hessian.empty()) out += "/" + trial.hessian;
  return trial.exact_friction ? out + "/exact_friction" : out;
}

std::vector<CorpusTrial> corpus_trials(const std::vector<std::string>& names) {
  std::vector<CorpusTrial> all = all_trials();
  std::vector<std::string> known;
  for (const CorpusTrial& trial : all) known.push_back(trial_name(trial));
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw ConfigError("--trials", '"' + name + '"', fmt::format("{}", fmt::join(known, ", ")));
  }
  std::erase_if(all, [&names](const CorpusTrial& trial) {
    return !names.empty() && std::find(names.begin(), names.end(), trial_name(trial)) == names.end();
  });
  return all;
}

CorpusState take_state(const StepState& state, const CorpusChoice& choice, const RunOptions& options,
                       const std::function<void(const std::string&)>& tell) {
  const auto threads = threads_of(state.config);
  const double start = processor_seconds();
  CorpusState out = described(state);
  const auto begin = [&](const std::string& what) {
    if (options.interrupted && options.interrupted->load()) throw Interrupted{};
    if (tell) tell(fmt::format("{}: {}", state.name, what));
  };
  if (choice.reference) begin("reference");
  Minima minima(out.tolerance_m);
  out.has_reference = choice.reference;
  try {
    if (choice.reference) find_reference(state, minima, out);
  } catch (const ConfigError& error) {
    out.refused = refusal_of(error);
    return out;
  }
  out.trials = choice.trials;
  for (CorpusTrial& trial : out.trials) {
    begin(trial_name(trial));
    try {
      take_trial(state, minima, trial);
    } catch (const ConfigError& error) {
      trial.refused = refusal_of(error);
    }
  }
  out.seconds = processor_seconds() - start;
  return out;
}

}  // namespace bb
