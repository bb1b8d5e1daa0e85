#include "experiments/run/step_trial.hpp"

#include <fmt/format.h>

#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/base/archive/archive.hpp"
#include "core/math/error.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

/// Relies on an iteration being shown before its motion.
class StepWatch final : public StepObserver {
 public:
  StepWatch(TakenStep& out, const Positions& start, bool keeps_states)
      : out_(out), start_(start), x_(start), keeps_states_(keeps_states) {}
  void on_iteration(const IterationReport& report) override {
    out_.iterations.push_back(report);
    if (keeps_states_) out_.states.push_back(x_);
  }
  void on_retry(int) override {
    out_.iterations.clear(), out_.states.clear();
    x_ = start_;
  }
  bool watches_motions() const override { return keeps_states_; }
  void on_motion(const Positions&, const Positions& x1, int) override {
    x_ = x1;
    if (!out_.states.empty()) out_.states.back() = x1;
  }

 private:
  TakenStep& out_;
  const Positions& start_;
  Positions x_;
  bool keeps_states_;
};

/// A method and its simulation, which has to find it where it is.
struct Trial {
  Method method;
  std::unique_ptr<Simulation> simulation;
};

std::unique_ptr<Trial> make_trial(const StepSetting& setting, const StepVariant& variant) {
  auto out = std::make_unique<Trial>(Trial{make_method(setting.config, setting.calibration), nullptr});
  if (variant.hessian) {
    for (auto& [term, choice] : out->method.step_hessian) choice = *variant.hessian;
  }
  out->method.step_solver.tol_velocity /= variant.finer;
  out->simulation = std::make_unique<Simulation>(setting.scene, out->method, setting.plan,
                                                 setting.config.time.dt, setting.config.time.steps);
  return out;
}

/// Errors: std::logic_error.
void read_all(Simulation& simulation, const std::string& bytes) {
  Archive archive(bytes);
  simulation.keep(archive);
  if (!archive.at_end()) throw std::logic_error("archive: more than this simulation keeps");
}

}  // namespace

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

nlohmann::ordered_json json_of(const Number& number) {
  return number.finite() ? nlohmann::ordered_json(number.value) : nlohmann::ordered_json();
}

std::vector<StepStart> step_starts(const StepSetting& setting, const std::vector<int>& steps,
                                   const char* option, const RunOptions& options) {
  const auto trial = make_trial(setting, {});
  Simulation& simulation = *trial->simulation;
  StepObserver nobody;
  std::vector<StepStart> out;
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
          option, std::to_string(steps[out.size()]),
          fmt::format("a step up to {}: there the run ends with {}", step, to_string(report.status)));
    }
  }
  return out;
}

TakenStep take_step(const StepSetting& setting, const std::string& archive, const StepVariant& variant) {
  TakenStep out;
  auto trial = make_trial(setting, variant);
  try {
    read_all(*trial->simulation, archive);
  } catch (const std::logic_error&) {  // of other terms than those of the run
    out.has_memory = false;
    trial = make_trial(setting, variant);
    Archive motion(archive);
    trial->simulation->keep_motion(motion);
  }
  StepWatch watch(out, trial->simulation->history().x, variant.keeps_states);
  const double begin = processor_seconds();
  out.report = trial->simulation->step(watch);
  out.seconds = processor_seconds() - begin;
  out.tolerance_m = trial->method.step_solver.tol_velocity * setting.config.time.dt;
  out.end = trial->simulation->history().x;
  return out;
}

}  // namespace bb
