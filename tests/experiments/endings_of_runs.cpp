// Runs that end as only their surroundings can make them: no time, no memory, a device that fails, a library that gives up.
#include <cholmod.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>

#include "core/model/integrators/registry.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/audit_verdict.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/recorder.hpp"
#include "experiments/run/runner.hpp"
#include "tests/experiments/endings.hpp"
#include "tests/newton/small_scenes.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::test {
namespace {

bool factors_are_too_large = false;

/// Hands on the steps to the record and keeps the motions from its audit.
class Deaf final : public StepObserver {
 public:
  explicit Deaf(Recorder& recorder) : recorder_(recorder) {}
  void on_iteration(const IterationReport& report) override { recorder_.on_iteration(report); }
  void on_step(StepSystem& system, const StepReport& report, const Positions& x) override {
    recorder_.on_step(system, report, x);
  }

 private:
  Recorder& recorder_;
};

/// implicit_euler, until its third step runs out of memory.
class Greedy final : public Integrator {
 public:
  std::string_view name() const override { return "greedy"; }
  void predict(const History& history, double dt, Prediction& out) const override {
    if (history.steps >= 2) throw std::bad_alloc();
    euler_->predict(history, dt, out);
  }
  void finish(const History& history, double dt, const Prediction& used, const Positions& x, Positions& v,
              Positions& a) const override {
    euler_->finish(history, dt, used, x, v, a);
  }

 private:
  std::unique_ptr<Integrator> euler_ = make_integrator("implicit_euler");
};

}  // namespace

Ending run(const std::string& config, const Overrides& overrides, double time_limit_s) {
  RunOptions options;
  const TemporaryFolder folder;
  options.folder = folder;
  options.time_limit_s = time_limit_s;
  const RunRecord record = run_config(parse_config(config, "test", ".", overrides), options);
  Ending out{record.status.outcome, record.status.detail, {}, {}, 0};
  for (const StepRecord& step : record.steps) {
    out.steps.emplace(to_string(step.status));
    out.contacts += static_cast<double>(step.contacts.total());
  }
  std::ifstream trace(options.folder / "trace.jsonl");
  for (std::string line; std::getline(trace, line);) {
    out.solves.insert(nlohmann::json::parse(line)["linear_status"].get<std::string>());
  }
  EXPECT_TRUE(std::filesystem::exists(options.folder / "run.json"));
  return out;
}

Ending factor_too_large() {
  factors_are_too_large = true;
  const Ending out = run(resting_block);
  factors_are_too_large = false;
  return out;
}

Ending unjudged() {
  const RunConfig config = parse_config(resting_block, "test", ".", {});
  const Scene scene = build_scene(config);
  Method method = test::fixed_method("log", 1);
  Simulation simulation(scene, method, config.time.dt, config.time.steps);
  RunRecord record;
  Recorder recorder(config, scene, record, nullptr, nullptr);
  Deaf deaf(recorder);
  simulation.step(deaf);
  recorder.finish();
  const Verdict verdict = recorder.audit_verdict();
  return {verdict.outcome, verdict.detail, {}, {}, 0};
}

Ending greedy() {
  if (!integrators().find("greedy")) {
    IntegratorEntry entry;
    entry.name = "greedy";
    entry.make = [](const ParameterMap&) -> std::unique_ptr<Integrator> {
      return std::make_unique<Greedy>();
    };
    integrators().add(std::move(entry), "test");
  }
  return run(resting_block, {R"(/integrator={"name": "greedy"})"});
}

/// The record of a run whose device fails; its checkpoint is there too.
Ending failing() {
  ::setenv("BARRIERBENCH_FAIL_KERNEL", "MultiplyDot:1", 1);
  RunOptions options;
  const TemporaryFolder folder;
  options.folder = folder;
  const RunConfig config = parse_config(resting_block, "test", ".", Overrides{"/device=host"});
  EXPECT_THROW(run_config(config, options), DeviceStopped);
  ::unsetenv("BARRIERBENCH_FAIL_KERNEL");
  EXPECT_TRUE(std::filesystem::exists(options.folder / "checkpoint.bin"));
  std::ifstream file(options.folder / "run.json");
  const auto status = nlohmann::json::parse(file)["status"];
  EXPECT_EQ(status["outcome"], "kernel_failed");
  return {Outcome::kernel_failed, status["detail"].get<std::string>(), {}, {}, 0};
}

}  // namespace bb::test

// The linker puts these in the places of the call and of what it would have called.
extern "C" {
int __real_cholmod_factorize(cholmod_sparse* a, cholmod_factor* factor, cholmod_common* common);
int __wrap_cholmod_factorize(cholmod_sparse* a, cholmod_factor* factor, cholmod_common* common) {
  if (!bb::test::factors_are_too_large) return __real_cholmod_factorize(a, factor, common);
  common->status = CHOLMOD_TOO_LARGE;
  return 0;
}
}
