#include "experiments/run/runner.hpp"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include <algorithm>
#include <cmath>

#include "core/linear/blas_info.hpp"
#include "core/math/error.hpp"
#include "core/newton/simulation.hpp"
#include "core/record/folder_lock.hpp"
#include "core/record/provenance.hpp"
#include "core/record/run_folder.hpp"
#include "core/record/writer.hpp"
#include "core/terms/plan.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"
#include "experiments/run/comparability.hpp"
#include "experiments/run/input_files.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/outcome.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/recorder.hpp"
#include "experiments/run/start_check.hpp"
#include "experiments/run/validity.hpp"

namespace bb {
namespace {

/// One simulation from start to end, seen by one observer.
struct PassResult {
  Verdict verdict;
  std::string state_hash;
  struct StepTime {
    double wall_s;  // on its own clock, round the whole step
    PhaseTimes phases;
  };
  std::vector<StepTime> steps;
  double wall_s = 0;  // of all steps
  StiffnessPolicy::State stiffness;
};

PassResult run_pass(const RunConfig& config, const Scene& scene, const Calibration& calibration,
                    const Plan& plan, const RunOptions& options, const char* pass, StepObserver& observer) {
  Method method = make_method(config, calibration);
  Simulation simulation(scene, method, plan, config.time.dt, config.time.steps);
  PassResult result;
  const double start = now_s();
  const double t_end = config.time.dt * config.time.steps * (1 - 1e-9);
  Progress progress;
  progress.label = run_label(config);
  progress.pass = pass;
  progress.steps = config.time.steps;
  while (simulation.time() < t_end) {
    if (options.interrupted && options.interrupted->load()) throw Interrupted{};
    const double step_start = now_s();
    const StepReport step = simulation.step(observer);
    result.steps.push_back({now_s() - step_start, step.time});
    result.wall_s += result.steps.back().wall_s;
    result.verdict = judge_step(step);
    if (options.progress) {
      progress.step = static_cast<int>(std::lround(step.t_s / config.time.dt));
      progress.newton = step.newton_iterations;
      progress.contacts = step.contacts.total();
      progress.gap = step.gap_min_m;
      progress.elapsed_s = now_s() - start;
      progress.eta_s = progress.elapsed_s * std::max(0.0, t_end / simulation.time() - 1);
      options.progress(progress);
    }
    if (result.verdict.outcome != Outcome::ok) break;
  }
  result.state_hash = state_hash(simulation.history().x);
  result.stiffness = method.stiffness->state();
  return result;
}

void fill_labels(const RunConfig& config, const RunOptions& options, RunRecord& record) {
  Labels& labels = record.labels;
  labels.scene = config.scene.name;
  labels.formulation = label_of(config.formulation);
  labels.shape = config.formulation.shape;
  labels.argument = std::string(to_string(config.formulation.argument));
  labels.stiffness_policy = config.formulation.stiffness_policy.name;
  labels.integrator = config.integrator.name;
  labels.step_solver = config.step_solver.name;
  labels.linear_solver = config.linear_solver.name;
  labels.preconditioner = preconditioner_of({config.linear_solver.name, config.linear_solver.parameters});
  labels.precision = config.precision;
  labels.d_hat_m = config.formulation.d_hat;
  labels.dt_s = config.time.dt;
  labels.note = options.note;
}

void fill_scene(const Scene& scene, RunRecord& record) {
  SceneSize& size = record.scene;
  size.vertices = static_cast<std::size_t>(scene.n_vertices());
  const std::size_t per_vertex = scene.planar ? 2 : 3;
  size.free_dofs = per_vertex * (size.vertices - scene.pins.size());
  size.triangles = scene.membrane_triangles().size();
  size.springs = scene.springs.edges.size();
  size.hinges = scene.hinges.hinges.size();
  size.obstacles = scene.obstacles.size();
  size.extent_m = (scene.x0.rowwise().maxCoeff() - scene.x0.rowwise().minCoeff()).maxCoeff();
}

/// Written beside the record; they get their names when the run is over.
struct RunFiles {
  std::optional<TraceWriter> trace;
  std::optional<ArtifactWriter> artifacts;

  void finish() {
    if (trace) trace->finish();
    if (artifacts) artifacts->finish();
  }
};

void fill_plan(const RunConfig& config, const Plan& plan, RunRecord& record) {
  for (const auto& [name, item] : plan.items()) {
    record.plan.push_back({std::string(name), item->needed, item->reason});
  }
  if (!config.passes.time) record.skipped.push_back({"time", "not_requested"});
  if (config.passes.time && !record.validity.build.valid)
    record.skipped.push_back({"time", "build_not_valid"});
  if (!plan.conditioning.needed) record.skipped.push_back({"cond", "not_requested"});
  if (!plan.audit.needed) record.skipped.push_back({"audit", "not_requested"});
  if (!plan.trace.needed) record.skipped.push_back({"trace", "not_requested"});
}

/// Times of the pass that was timed; a step that it did not reach has none. A build that is not valid shows none.
void fill_times(const PassResult& timed, bool requested, RunRecord& record) {
  Summary& summary = record.summary;
  const bool shown = record.validity.build.valid;
  const Number absent = Number::missing(!requested ? "not_requested"
                                        : shown    ? "not_reached"
                                                   : "build_not_valid");
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    StepRecord& step = record.steps[i];
    step.wall_s = step.unaccounted_s = absent;
    if (!shown || i >= timed.steps.size()) continue;
    step.time = timed.steps[i].phases;
    step.wall_s = timed.steps[i].wall_s;
    step.unaccounted_s = timed.steps[i].wall_s - step.time.total_s();
  }
  summary.wall_s = summary.solve_s = summary.unaccounted_s = absent;
  if (!requested || !shown) return;
  record.samples["wall_s"] = {timed.wall_s};
  for (const PassResult::StepTime& step : timed.steps) summary.time += step.phases;
  summary.wall_s = timed.wall_s;
  summary.solve_s = summary.time.solve_s();
  summary.unaccounted_s = timed.wall_s - summary.time.total_s();
}

void merge(Verdict& verdict, Outcome outcome, const std::string& detail) {
  if (worse(outcome, verdict.outcome) == outcome && outcome != verdict.outcome) verdict = {outcome, detail};
}

// The passes: `time` runs alone, `diagnose` and `audit` share a run, and none of their time is reported
// as a time.
void run_passes(const RunConfig& config, const Scene& scene, const Plan& plan, const Calibration& calibration,
                const RunOptions& options, RunRecord& record, RunFiles& files) {
  PassResult timed, seen;
  const bool look = has_observed_run(config);
  RunRecord timing;               // the time pass keeps a record of its own: only its times and hash are used
  std::vector<PhaseTimes> times;  // of the iterations
  if (config.passes.time) {
    RunConfig bare = config;
    bare.passes = {true, false, false};
    Recorder observer(bare, scene, look ? timing : record, nullptr);
    timed = run_pass(bare, scene, calibration, plan, options, "time", observer);
    observer.finish();
    if (options.build.valid) times = observer.iteration_times();
  }
  Verdict verdict = timed.verdict;
  std::optional<audit::AuditLedger> ledger;
  if (look) {
    files.trace.emplace(options.folder);
    files.artifacts.emplace(options.folder, scene);
    Recorder observer(config, scene, record, &*files.trace, &*files.artifacts);
    observer.report_times(times);
    seen = run_pass(config, scene, calibration, plan, options, "diagnose", observer);
    observer.finish();
    record.artifacts = files.artifacts->written();
    verdict = seen.verdict;
    if (observer.ledger()) ledger = *observer.ledger();
    const Verdict audited = observer.audit_verdict();
    merge(verdict, audited.outcome, audited.detail);
  }
  const PassResult& main = look ? seen : timed;
  record.status.outcome = verdict.outcome;
  record.status.detail = verdict.detail;
  fill_times(timed, config.passes.time, record);
  record.summary.state_hash = main.state_hash;
  if (main.stiffness.kappa > 0) {
    record.summary.stiffness = {main.stiffness.kappa_start, main.stiffness.kappa, main.stiffness.doublings,
                                main.stiffness.saturated};
  }
  fill_validity(scene, ledger ? &*ledger : nullptr, timed.state_hash, seen.state_hash, record);
}

// From the scene to the outcome. A scene that cannot start, or cannot be matched, is an outcome: only its
// geometry or its pilot can show that.
void simulate(const RunConfig& config, const Scene& scene, const RunOptions& options, RunRecord& record,
              RunFiles& files) {
  fill_scene(scene, record);
  record.matching.rule = to_string(config.matching.rule);
  const Plan plan = plan_of(config, scene);
  fill_plan(config, plan, record);
  if (const auto failure = start_failure(config, scene, options.interrupted)) {
    record.status.outcome = failure->outcome;
    record.status.detail = failure->detail;
    return;
  }
  Calibration calibration;
  try {
    calibration = calibrate(config, scene, options, record.matching);
  } catch (const ConfigError& error) {  // of what only the scene or its pilot can tell: no first step
    record.status.outcome = Outcome::invalid_scene;
    record.status.detail = error.what();
    return;
  }
  run_passes(config, scene, plan, calibration, options, record, files);
}

int thread_count(const RunConfig& config) {
  return config.threads > 0 ? config.threads : oneapi::tbb::info::default_concurrency();
}

}  // namespace

std::string run_label(const RunConfig& config) {
  return fmt::format("{}-{}-{}", config.scene.name, label_of(config.formulation),
                     config_id(config).substr(0, 8));
}

RunRecord identified(const RunConfig& config, const RunOptions& options) {
  RunRecord record;
  record.passes = {config.passes.time, config.passes.diagnose, config.passes.audit};
  const RunConfig named = name_from(options.folder, config);
  record.config.text = resolved_json(named);
  for (const BodyConfig& body : named.scene.bodies) {
    if (!body.mesh.file.empty()) record.scene.mesh_sha256[body.mesh.file] = body.mesh.sha256;
  }
  record.provenance = collect_provenance(options.argv, thread_count(config));
  record.provenance.plugins = name_from(options.folder, options.plugins);
  record.machine = collect_machine();
  if (!options.sweep_id.empty()) record.ids.sweep_id = options.sweep_id;
  if (!options.rerun_of.empty()) record.ids.rerun_of = options.rerun_of;
  fill_ids(record);
  return record;
}

RunRecord run_config(const RunConfig& asked, const RunOptions& given) {
  RunConfig config = asked;
  decide_linear_solver(config);
  RunOptions options = given;
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(thread_count(config)));
  set_one_blas_thread();  // before the record says how many there are, and before anything computes
  // before anything is written: what config and files can tell is refused here
  const Scene scene = build_scene(config);
  const std::string started_utc = utc_now();
  const FolderLock lock(options.folder);
  remove_unfinished(options.folder);
  check_writable(options.folder);
  if (options.keep_inputs) copy_inputs(options.folder, config, options.plugins);
  RunRecord record = identified(config, options);
  record.status.started_utc = started_utc;
  record.validity.build = options.build;

  RunFiles files;
  simulate(config, scene, options, record, files);
  fill_labels(config, options, record);
  record.comparability = judge_comparability(compared_run(record, options.folder), std::nullopt);
  record.status.ended_utc = utc_now();
  record.summary.peak_rss_bytes = peak_rss_bytes();
  StagedFile run_json(options.folder / "run.json", to_json(record));
  remove_earlier_run(options.folder);
  files.finish();
  run_json.commit();
  return record;
}

}  // namespace bb
