// Every word that a run, a step or a linear solve may end with, reached by a run or by a small simulation, with what
// its message has to name. A word without a case makes the last test red.
#include <cholmod.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <nlohmann/json.hpp>
#include <set>

#include "core/integrators/registry.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/audit_verdict.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/recorder.hpp"
#include "experiments/run/runner.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb {
namespace {

struct Ending {
  Outcome outcome = Outcome::ok;
  std::string detail;
  std::set<std::string> steps, solves;  // words of all steps, of all linear solves
  double contacts = 0;                  // over all steps
};

using Overrides = std::vector<std::string>;

constexpr const char* block = R"({"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"},
  "formulation": {"name": "cubic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force", "load_N": 1},
  "passes": {"time": false, "audit": true}, "time": {"steps": 3}})";

/// The record of a run, and the solves of its trace.
Ending run(const std::string& config, const Overrides& overrides = {}, double time_limit_s = 0) {
  RunOptions options;
  options.folder =
      std::filesystem::temp_directory_path() / ("barrierbench_outcomes_" + std::to_string(::getpid()));
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
  std::filesystem::remove_all(options.folder);
  return out;
}

class Watch final : public StepObserver {
 public:
  explicit Watch(Ending& out) : out_(out) {}
  void on_iteration(const IterationReport& report) override {
    out_.solves.emplace(to_string(report.linear_status));
    out_.contacts += static_cast<double>(report.contacts.total());
  }

 private:
  Ending& out_;
};

/// The steps of a simulation up to the first that does not converge, judged as a run's are.
Ending simulate(const Scene& scene, Method& method, int steps = 1) {
  Ending out;
  Watch watch(out);
  Simulation simulation(scene, method, 0.01, steps);
  for (int i = 0; i < steps && out.outcome == Outcome::ok; ++i) {
    const StepReport step = simulation.step(watch);
    const Verdict verdict = judge_step(step);
    out.steps.emplace(to_string(step.status));
    out.outcome = verdict.outcome;
    out.detail = verdict.detail;
  }
  return out;
}

bool factors_are_too_large = false;

Ending factor_too_large() {
  factors_are_too_large = true;
  const Ending out = run(block);
  factors_are_too_large = false;
  return out;
}

Scene particle(double height = 1) { return test::particle_over_plane(0.2, height, 0.01); }

Ending floating_particle(const LinearOptions& linear) {  // no inertia, nothing that holds it
  Method method = test::fixed_method("log", 1, "quasi_static");
  method.linear = linear;
  return simulate(particle(), method);
}

/// A shape whose energy does not belong to its force: no step along the force lowers E.
void inconsistent(void*, std::size_t n, const double* d, const double* d_hat, double* b, double* db,
                  double* d2b) {
  for (std::size_t i = 0; i < n; ++i) {
    const double depth = std::max(0.0, d_hat[i] - d[i]);
    b[i] = -depth * depth;
    db[i] = -2 * depth;
    d2b[i] = depth > 0 ? 2 : 0;
  }
}

Ending shape_without_a_potential() {
  Method method = test::fixed_method("cubic", 1e6);
  method.contact.shape = Shape{"inconsistent", "", 1, true, inconsistent, nullptr, nullptr};
  return simulate(particle(0.005), method);
}

Ending stiffness_that_overflows() {  // kappa b'' is infinite, the force is not
  Method method = test::fixed_method("cubic", 1e308);
  return simulate(particle(0.005), method);
}

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

Ending unjudged() {
  const RunConfig config = parse_config(block, "test", ".", {});
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

Ending slope_that_underflows() {
  Scene scene = particle();
  scene.gravity = Vec3d(0, 0, -1e-170);
  Method method = test::fixed_method("log", 1);
  method.step_solver.tol_velocity = 1e-300;
  return simulate(scene, method);
}

Ending torn_cloth() {
  SceneBuilder builder("torn cloth", false, Vec3d::Zero(), "test");
  BodySpec spec = test::cloth_spec(3, 0, 0.001);
  spec.material.limit = StrainLimitSpec::from_limit(0.02);
  PinSpec left, right;
  left.indices = {0, 3, 6};
  right.indices = {2, 5, 8};
  right.motion.velocity = Vec3d(5, 0, 0);
  spec.pins = {left, right};
  builder.add_body(spec);
  Method method = test::fixed_method("log", 1);
  method.limit_stiffness.k_s = 10;
  return simulate(builder.finish(), method, 2);
}

Ending few_probes() {  // a fast cloth that may not look whether it touches
  SceneBuilder builder("thrown cloths", false, Vec3d::Zero(), "test");
  BodySpec upper = test::cloth_spec(3, 0.03, 0.001), lower = test::cloth_spec(4, 0, 0.001);
  upper.name = "upper";
  upper.velocity = Vec3d(0, 0, -50);
  builder.add_body(upper);
  builder.add_body(lower);
  Method method = test::fixed_method("log", 1);
  method.contact_options.ccd_max_probes = 0;
  return simulate(builder.finish(), method, 5);
}

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

Ending greedy() {
  if (!integrators().find("greedy")) {
    IntegratorEntry entry;
    entry.name = "greedy";
    entry.make = [](const ParameterMap&) -> std::unique_ptr<Integrator> {
      return std::make_unique<Greedy>();
    };
    integrators().add(std::move(entry), "test");
  }
  return run(block, {R"(/integrator={"name": "greedy"})"});
}

/// The record of a run whose device fails; its checkpoint is there too.
Ending failing() {
  ::setenv("BARRIERBENCH_FAIL_KERNEL", "MultiplyDot:1", 1);
  RunOptions options;
  options.folder =
      std::filesystem::temp_directory_path() / ("barrierbench_failing_" + std::to_string(::getpid()));
  const RunConfig config = parse_config(block, "test", ".", Overrides{"/device=host"});
  EXPECT_THROW(run_config(config, options), DeviceStopped);
  ::unsetenv("BARRIERBENCH_FAIL_KERNEL");
  EXPECT_TRUE(std::filesystem::exists(options.folder / "checkpoint.bin"));
  std::ifstream file(options.folder / "run.json");
  const auto status = nlohmann::json::parse(file)["status"];
  std::filesystem::remove_all(options.folder);
  EXPECT_EQ(status["outcome"], "kernel_failed");
  return {Outcome::kernel_failed, status["detail"].get<std::string>(), {}, {}, 0};
}

std::string grids(const std::string& more) {
  return R"({"schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": 0.01},
    "passes": {"time": false, "audit": true}, "time": {"dt_s": 0.01, "steps": 2}, "scene": {"bodies": [
      {"name": "cloth", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}},
      {"name": "other", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "transform": )" +
         more + R"(}, {"name": "free", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2},
        "transform": {"translate_m": [0, 0, 5]}}]}})";
}

const char* hanging =
    R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "pinned", "n": 6},
  "formulation": "log", "passes": {"time": false, "audit": true}, "time": {"steps": 2},
  "linear_solver": {"name": "pcg", "forcing": "fixed"}})";

struct Case {
  const char* name;
  Outcome outcome;
  const char *step, *solve;  // words among those of its steps and solves; null: not asked
  std::vector<std::string> says;
  std::function<Ending()> reach;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"a block that comes to rest", Outcome::ok, "converged", "ok", {}, [] { return run(block); }},
      {"prescribed bodies that cross",
       Outcome::invalid_scene,
       nullptr,
       nullptr,
       {"cloth[", "other["},
       [] {
         return run(grids(R"({"axis": [1, 0, 0], "angle_deg": 90, "translate_m": [0.1, 0.1, 0.05]})"),
                    {R"(/scene/bodies/0/kind="rigid")", R"(/scene/bodies/1/kind="rigid")"});
       }},
      {"bodies that cross at the start",
       Outcome::initial_intersection,
       nullptr,
       nullptr,
       {"cloth[", "other["},
       [] { return run(grids(R"({"axis": [1, 0, 0], "angle_deg": 90, "translate_m": [0.1, 0.1, 0.05]})")); }},
      {"pairs of vertices alone",
       Outcome::penetration,
       "converged",
       "ok",
       {"the first in step", "triangle sheet", "enters obstacle disk", "has no edge pairs"},
       [] {
         return run(R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "stack",
           "pairs": "vertex_vertex"}, "formulation": "quadratic", "matching": {"rule": "equal_force"},
           "passes": {"time": false, "audit": true}, "time": {"dt_s": 0.01, "steps": 4}})");
       }},
      {"a stiffness that overflows",
       Outcome::nan,
       "non_finite",
       "non_finite",
       {"step 0", "term contact", "particle[0]"},
       stiffness_that_overflows},
      {"a pin beyond the strain limit",
       Outcome::pin_infeasible,
       "pin_infeasible",
       "ok",
       {"step ", "vertex", "'cloth'"},
       torn_cloth},
      {"no probe of a pair",
       Outcome::ccd_cap,
       "step_collapse",
       "ok",
       {"probe cap", "held by", "upper["},
       few_probes},
      {"a weight over the capacity",
       Outcome::stall_overload,
       nullptr,
       "ok",
       {"load over capacity", "obstacle: ", "block["},
       [] {
         return run(block, {R"(/formulation/stiffness_policy={"name": "fixed", "kappa_N_per_m": 1})",
                            R"(/matching={"rule": "as_given"})", "/time/steps=100"});
       }},
      {"one iteration",
       Outcome::newton_stall,
       "iteration_cap",
       "ok",
       {"step 0", "iteration_cap", "|dx|"},
       [] { return run(block, {"/step_solver/max_iterations=1"}); }},
      {"a force without a potential",
       Outcome::newton_stall,
       "line_search_failed",
       "ok",
       {"line_search_failed"},
       shape_without_a_potential},
      {"a slope that underflows",
       Outcome::newton_stall,
       "not_descent",
       "ok",
       {"not_descent", "g . dx"},
       slope_that_underflows},
      {"one iteration of PCG",
       Outcome::linear_failure,
       "linear_failed",
       "iteration_cap",
       {"iteration_cap", "residual", "1 iterations"},
       [] {
         return run(hanging, {"/linear_solver/max_iterations=1", "/linear_solver/tol_rel=1e-12"});
       }},
      {"a tolerance of 1e-18",
       Outcome::linear_failure,
       "linear_failed",
       "tolerance_below_rounding",
       {"tolerance_below_rounding", "residual"},
       [] { return run(hanging, {"/linear_solver/tol_rel=1e-18"}); }},
      {"a diagonal of zeros",
       Outcome::linear_failure,
       "linear_failed",
       "preconditioner_indefinite",
       {"preconditioner_indefinite", "vertex 0"},
       [] {
         return floating_particle({"pcg", {{"preconditioner", "jacobi"}}});
       }},
      {"a particle that nothing holds",
       Outcome::not_pd,
       "linear_failed",
       "matrix_indefinite",
       {"matrix_indefinite", "vertex 0"},
       [] { return floating_particle({}); }},
      {"memory that runs out", Outcome::oom, "converged", "ok", {"step 2", "memory"}, greedy},
      {"a kernel that fails", Outcome::kernel_failed, nullptr, nullptr, {"step 0", "MultiplyDot"}, failing},
      {"a factor that is too large",
       Outcome::linear_failure,
       "linear_failed",
       "factor_too_large",
       {"step 0", "factor_too_large", "32-bit"},
       factor_too_large},
      {"no time",
       Outcome::timeout,
       nullptr,
       nullptr,
       {"time limit", "start check", "there was no first step"},
       [] { return run(block, {}, 1e-9); }},
      {"motions that were not judged",
       Outcome::unproven,
       nullptr,
       nullptr,
       {"no judged motion", "in step 0"},
       unjudged},
  };
  return all;
}

template <class E>
std::set<std::string> words() {
  std::set<std::string> out;
  for (int i = 0; i < n_words<E>; ++i) out.emplace(to_string(static_cast<E>(i)));
  return out;
}

TEST(EveryOutcome, is_reached_and_named) {
  std::set<std::string> outcomes, steps, solves;
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    Ending end;
    EXPECT_NO_THROW(end = one.reach());
    EXPECT_EQ(end.outcome, one.outcome) << one.name << ": " << to_string(end.outcome) << ", " << end.detail;
    EXPECT_TRUE(!one.step || end.steps.contains(one.step)) << one.name << ": " << end.detail;
    EXPECT_TRUE(!one.solve || end.solves.contains(one.solve)) << one.name << ": " << end.detail;
    for (const std::string& part : one.says) {
      EXPECT_NE(end.detail.find(part), std::string::npos)
          << one.name << ": '" << part << "' in " << end.detail;
    }
    EXPECT_EQ(end.detail.empty(), one.outcome == Outcome::ok) << one.name;
    outcomes.emplace(to_string(one.outcome));
    if (one.step) steps.insert(one.step);
    if (one.solve) solves.insert(one.solve);
  }
  EXPECT_EQ(outcomes, words<Outcome>());
  EXPECT_EQ(steps, words<StepStatus>());
  EXPECT_EQ(solves, words<LinearStatus>());
}

TEST(EveryOutcome, contacts_are_there_where_they_decide) {
  int asked = 0;
  for (const Case& one : cases()) {
    if (one.outcome != Outcome::ok && one.outcome != Outcome::stall_overload) continue;
    EXPECT_GT(one.reach().contacts, 0) << one.name;
    ++asked;
  }
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace bb

// The linker puts these in the places of the call and of what it would have called.
extern "C" {
int __real_cholmod_factorize(cholmod_sparse* a, cholmod_factor* factor, cholmod_common* common);
int __wrap_cholmod_factorize(cholmod_sparse* a, cholmod_factor* factor, cholmod_common* common) {
  if (!bb::factors_are_too_large) return __real_cholmod_factorize(a, factor, common);
  common->status = CHOLMOD_TOO_LARGE;
  return 0;
}
}
