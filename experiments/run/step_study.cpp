#include "experiments/run/step_study.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/step_trial.hpp"
#include "experiments/run/thread_limit.hpp"

namespace bb {
namespace {

StepTrial trial_of(const TakenStep& taken, int step, StepHessian hessian) {
  StepTrial out;
  out.step = step;
  out.hessian = to_string(hessian);
  out.status = taken.report.status;
  out.newton_iterations = taken.report.newton_iterations;
  out.linear_solves = taken.report.linear_solves;
  out.hessian_fallbacks = taken.report.hessian_fallbacks;
  out.tolerance_m = taken.tolerance_m;
  for (const IterationReport& report : taken.iterations) out.dx_inf_m.push_back(report.dx_inf_m);
  if (!taken.iterations.empty()) out.error_estimate_m = taken.iterations.back().error_estimate_m;
  out.contacts = taken.report.contacts.total();
  out.state_hash = state_hash(taken.end);
  return out;
}

void study_step(const StepSetting& setting, const StepStart& start, std::vector<StepTrial>& out) {
  const TakenStep fine = take_step(setting, start.bytes, {StepHessian::blend, reference_finer});
  for (const StepHessian hessian : all_step_hessians) {
    const TakenStep taken = take_step(setting, start.bytes, {hessian});
    StepTrial trial = trial_of(taken, start.step, hessian);
    if (fine.report.status == StepStatus::converged)
      trial.error_true_m = (taken.end - fine.end).cwiseAbs().maxCoeff();
    out.push_back(std::move(trial));
  }
}

}  // namespace

std::vector<StepTrial> study_steps(const RunConfig& config, const std::vector<int>& steps,
                                   const RunOptions& options) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] >= (i == 0 ? 0 : steps[i - 1] + 1) && steps[i] < config.time.steps) continue;
    throw ConfigError("--at", std::to_string(steps[i]),
                      fmt::format("ascending steps from 0 to {}", config.time.steps - 1));
  }
  if (steps.empty()) {
    throw ConfigError("--at", "no step", fmt::format("steps from 0 to {}", config.time.steps - 1));
  }
  const auto threads = threads_of(config);
  const Scene scene = build_scene(config);
  MatchingRecord matching;
  const Calibration calibration = calibrate(config, scene, options, matching);
  const StepSetting setting{config, scene, calibration, plan_of(config, scene)};
  std::vector<StepTrial> out;
  for (const StepStart& start : step_starts(setting, steps, "--at", options)) {
    if (options.interrupted && options.interrupted->load()) throw Interrupted{};
    study_step(setting, start, out);
  }
  return out;
}

std::string to_json(const RunConfig& config, const std::vector<StepTrial>& trials) {
  using json = nlohmann::ordered_json;
  json all = json::array();
  for (const StepTrial& t : trials) {
    all.push_back({{"step", t.step},
                   {"hessian", t.hessian},
                   {"status", to_string(t.status)},
                   {"newton_iterations", t.newton_iterations},
                   {"linear_solves", t.linear_solves},
                   {"hessian_fallbacks", t.hessian_fallbacks},
                   {"tolerance_m", t.tolerance_m},
                   {"error_estimate_m", json_of(t.error_estimate_m)},
                   {"error_true_m", json_of(t.error_true_m)},
                   {"contacts", t.contacts},
                   {"state_hash", t.state_hash},
                   {"dx_inf_m", t.dx_inf_m}});
  }
  const json out = {{"schema", "barrierbench.steps/1"},
                    {"config", json::parse(resolved_json(config))},
                    {"trials", std::move(all)}};
  return out.dump(1);
}

}  // namespace bb
