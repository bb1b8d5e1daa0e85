#include "experiments/run/step_study.hpp"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "core/base/archive/archive.hpp"
#include "core/base/record/provenance.hpp"
#include "core/math/error.hpp"
#include "core/step_solvers/simulation.hpp"
#include "core/terms/contact.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/plan.hpp"

namespace bb {
namespace {

/// The run in front of a step: an archive of its simulation, with the memory of its policies.
struct Start {
  int step;
  std::string bytes;
};

/// What all trials share.
struct Study {
  const RunConfig& config;
  const Scene& scene;
  const Calibration& calibration;
  const Plan plan;
};

class Watch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    dx_.push_back(report.dx_inf_m);
    estimate_ = report.error_estimate_m;
  }
  std::vector<double> dx_;
  Number estimate_;
};

std::vector<Start> starts(const Study& study, const std::vector<int>& steps, const RunOptions& options) {
  Method method = make_method(study.config, study.calibration);
  Simulation simulation(study.scene, method, study.plan, study.config.time.dt, study.config.time.steps);
  StepObserver nobody;
  std::vector<Start> out;
  for (int step = 0; out.size() < steps.size(); ++step) {
    if (step == steps[out.size()]) {
      Archive archive;
      simulation.keep(archive);
      out.push_back({step, archive.bytes()});
      if (out.size() == steps.size()) break;
    }
    if (options.interrupted && options.interrupted->load()) throw Interrupted{};
    const StepReport report = simulation.step(nobody);
    if (report.status != StepStatus::converged) {
      throw ConfigError(
          "--at", std::to_string(steps[out.size()]),
          fmt::format("a step up to {}: there the run ends with {}", step, to_string(report.status)));
    }
  }
  return out;
}

/// @param finer  the tolerance is divided by it
/// @param x      the end state
StepTrial run_step(const Study& study, const Start& start, StepHessian hessian, double finer, Positions& x) {
  Method method = make_method(study.config, study.calibration);
  for (auto& [term, choice] : method.step_hessian) choice = hessian;
  method.step_solver.tol_velocity /= finer;
  Simulation simulation(study.scene, method, study.plan, study.config.time.dt, study.config.time.steps);
  Archive archive(start.bytes);
  simulation.keep(archive);
  Watch watch;
  const StepReport report = simulation.step(watch);
  x = simulation.history().x;
  StepTrial out;
  out.step = start.step;
  out.hessian = to_string(hessian);
  out.status = report.status;
  out.newton_iterations = report.newton_iterations;
  out.linear_solves = report.linear_solves;
  out.hessian_fallbacks = report.hessian_fallbacks;
  out.tolerance_m = method.step_solver.tol_velocity * study.config.time.dt;
  out.error_estimate_m = watch.estimate_;
  out.dx_inf_m = watch.dx_;
  out.contacts = contact_state(simulation.system().diagnosis().terms()).size();
  out.state_hash = state_hash(x);
  return out;
}

void study_step(const Study& study, const Start& start, std::vector<StepTrial>& out) {
  constexpr double finer = 1000;
  Positions reference, x;
  const StepTrial fine = run_step(study, start, StepHessian::blend, finer, reference);
  for (const StepHessian hessian : all_step_hessians) {
    StepTrial trial = run_step(study, start, hessian, 1, x);
    if (fine.status == StepStatus::converged) trial.error_true_m = (x - reference).cwiseAbs().maxCoeff();
    out.push_back(std::move(trial));
  }
}

nlohmann::ordered_json json_of(const Number& n) {
  return n.finite() ? nlohmann::ordered_json(n.value) : nlohmann::ordered_json();
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
  const oneapi::tbb::global_control threads(
      oneapi::tbb::global_control::max_allowed_parallelism,
      config.threads > 0
          ? static_cast<std::size_t>(config.threads)
          : oneapi::tbb::global_control::active_value(oneapi::tbb::global_control::max_allowed_parallelism));
  const Scene scene = build_scene(config);
  MatchingRecord matching;
  const Calibration calibration = calibrate(config, scene, options, matching);
  const Study study{config, scene, calibration, plan_of(config, scene)};
  std::vector<StepTrial> out;
  for (const Start& start : starts(study, steps, options)) {
    if (options.interrupted && options.interrupted->load()) throw Interrupted{};
    study_step(study, start, out);
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
