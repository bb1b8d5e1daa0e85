#include "experiments/run/calibration_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/base/archive/archive.hpp"
#include "core/base/record/phase_times.hpp"
#include "core/exec/host_executor.hpp"
#include "core/math/error.hpp"
#include "core/model/mesh/topology.hpp"
#include "core/step_solvers/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration_replay.hpp"
#include "experiments/run/plan.hpp"

namespace bb {
namespace {

constexpr const char* this_part = "calibration run";

StaticLoads static_loads(const RunConfig& config, const Scene& scene) {
  double mass = 0;
  int n_free = 0;
  for (const double m : scene.mass) {
    mass += m;
    n_free += m > 0;
  }
  const double weight = mass * largest_gravity(scene.gravity, scene.gravity_keys);
  if (weight == 0) {
    throw ConfigError(config.source + "#/matching/load_N", "nothing",
                      "a load in N: the scene has no weight from which a calibration run could start");
  }
  StaticLoads out;
  out.contact = weight / n_free;
  double volume = 0;
  for (const auto& t : scene.solid_limit.tetrahedra) volume += tetrahedron_volume(scene.rest, t);
  if (volume > 0) out.solid_limit = weight / std::cbrt(volume * volume);
  if (scene.limit.triangles.empty()) return out;
  double area = 0;
  for (const auto& t : scene.limit.triangles) {
    const Vec3d a = scene.rest.col(t[1]) - scene.rest.col(t[0]);
    const Vec3d b = scene.rest.col(t[2]) - scene.rest.col(t[0]);
    area += 0.5 * a.cross(b).norm();
  }
  out.limit = weight / std::sqrt(area);
  return out;
}

// The calibration run: log on the gap for contact and limit, kappa putting the static weight per contact at d_hat/2
// (the limit: the weight per width at width/2). Everything else is the config's own.
RunConfig calibration_run_config(const RunConfig& config) {
  RunConfig calibration_run = config;
  calibration_run.formulation.name = "log";
  calibration_run.formulation.shape = "log";
  calibration_run.formulation.argument = Argument::gap;
  calibration_run.formulation.stiffness_policy = {};
  calibration_run.strain_limit.shape = "log";
  calibration_run.strain_limit.argument = Argument::gap;
  calibration_run.strain_limit.stiffness_policy = {};
  calibration_run.matching = {};
  calibration_run.strain_limit.solid_k_s.reset();  // that of its own log
  calibration_run.step_solver.name = "line_search";
  calibration_run.step_solver.saddle = SaddleRule::escape;  // loads are those of minima
  calibration_run.step_solver.retries = 0;  // its steps are all as long as those that read its loads
  calibration_run.time.step_size.reset(), calibration_run.time.step_iterations.reset();
  calibration_run.time.step_halvings.reset(), calibration_run.time.step_error.reset();
  calibration_run.output.checkpoint_every = 0;  // it has no folder
  calibration_run.passes = {};
  calibration_run.precision = Precision::full;  // what is compared between precisions has one stiffness
  if (calibration_run.device != Device::cpu) {  // and between devices
    calibration_run.device = Device::cpu;
    calibration_run.linear_solver = {};
  }
  return calibration_run;
}

Calibration calibration_run_stiffness(const RunConfig& calibration_run, const Scene& scene,
                                      const StaticLoads& loads) {
  Calibration out;
  out.limited = !scene.limit.triangles.empty();
  out.kappa = match_equal_force(log_barrier(), calibration_run.formulation.d_hat, loads.contact, 0.5);
  if (!scene.solid_limit.tetrahedra.empty()) {
    out.solid_k_s = match_equal_force(log_barrier(), scene.solid_limit.width.front(), loads.solid_limit, 0.5);
  }
  if (out.limited) {
    out.k_s = match_equal_force(log_barrier(), scene.limit.width.front(), loads.limit, 0.5);
  }
  return out;
}

/// The run has to do its passes after the steps that are shown here.
void show(const RunConfig& config, const RunOptions& options, const StepReport& step, double start_s) {
  if (!options.progress) return;
  Progress progress;
  progress.label = options.note;
  progress.pass = "calibration";
  progress.step = step.step + 1;
  progress.steps = config.time.steps;
  progress.newton = step.newton_iterations;
  progress.contacts = step.contacts.total();
  progress.gap = step.gap_min_m;
  progress.t_s = step.t_s;
  progress.t_end_s = config.time.dt * config.time.steps;
  progress.elapsed_s = now_s() - start_s;
  const int passes = int(config.passes.time) + int(has_observed_run(config));
  progress.eta_s =
      progress.elapsed_s / progress.step * std::max(0, (1 + passes) * progress.steps - progress.step);
  options.progress(progress);
}

// The answers of one step's end, each with its force.
void add_answers(const CalibrationRun& calibration_run, const StiffnessAnswers& answers,
                 const ContactTable& rows, LimitFamily* limit, const Scene& scene, const Positions& x,
                 AnswerSums& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) out.add_contact(rows, r, -rows.force(r), answers.contact[r]);
  if (!limit) return;
  limit->measure(x.data());
  for (std::size_t e = 0; e < scene.limit.width.size(); ++e) {
    const double y = limit->smallest_gap(e), width = scene.limit.width[e];
    if (y < width)
      out.add_limit(e, -*calibration_run.stiffness.k_s * log_barrier().eval(y, width).db, answers.limit[e]);
  }
}

// How the forces at the ends of all steps answer to stiffness.
void answer(CalibrationRun& calibration_run, const Scene& scene, const RunOptions& options) {
  const StrainLimitPart& part = scene.limit;
  exec::HostExecutor executor;
  std::unique_ptr<LimitFamily> limit;
  if (!part.triangles.empty()) limit = limited_triangles({executor}, part, scene.rest, scene.planar);
  CalibrationReplay replay(calibration_run, scene);
  calibration_run.answers = AnswerSums(scene.n_vertices(), part.triangles.size());
  for (int step = 0; step < calibration_run.steps(); ++step) {
    options.limits().look_up(this_part, fmt::format("while the forces of its step {} of {} were read", step,
                                                    calibration_run.steps()));
    const StiffnessAnswers answers = answers_to_stiffness(replay.assembled(step), limit.get(), log_barrier(),
                                                          calibration_run.config.time.dt);
    calibration_run.unanswered += answers.known ? 0 : 1;
    add_answers(calibration_run, answers, replay.rows(), limit.get(), scene, replay.end(step),
                calibration_run.answers);
  }
}

}  // namespace

std::size_t CalibrationRun::bytes() const {
  const std::size_t states = x.empty() ? 0 : x.size() * static_cast<std::size_t>(x[0].size());
  std::size_t remembered = 0;
  for (const std::string& archive : memory) remembered += archive.size();
  return states * sizeof(double) + remembered + answers.bytes();
}

BarrierFunction log_barrier() { return {require_shape("log"), Argument::gap}; }

std::shared_ptr<const CalibrationRun> CalibrationRunCache::find(const std::string& config_id) {
  const auto found = std::find_if(known_.begin(), known_.end(), [&](const auto& calibration_run) {
    return calibration_run->config_id == config_id;
  });
  if (found == known_.end()) return nullptr;
  std::rotate(found, std::next(found), known_.end());
  return known_.back();
}

std::shared_ptr<const CalibrationRun> CalibrationRunCache::keep(CalibrationRun calibration_run) {
  known_.push_back(std::make_shared<const CalibrationRun>(std::move(calibration_run)));
  std::size_t total = 0, first = known_.size();
  while (first > 0 && (first == known_.size() || total + known_[first - 1]->bytes() <= bytes_)) {
    total += known_[--first]->bytes();
  }
  known_.erase(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(first));
  return known_.back();
}

std::shared_ptr<const CalibrationRun> run_calibration(const RunConfig& config, const Scene& given,
                                                      const RunOptions& options) {
  static CalibrationRunCache cache(std::size_t{256} << 20);
  CalibrationRun run;
  run.config = calibration_run_config(config);
  run.config_id = config_id(run.config);
  if (auto known = cache.find(run.config_id)) return known;

  // a scene whose start was rounded to float would leave other loads, in whatever run of a sweep came first
  const Scene unrounded = values_in_float(config.precision) ? build_scene(run.config) : Scene();
  const Scene& scene = values_in_float(config.precision) ? unrounded : given;
  const double dt = run.config.time.dt;
  run.rest = static_loads(config, scene);
  run.stiffness = calibration_run_stiffness(run.config, scene, run.rest);
  Method method = make_method(run.config, run.stiffness);
  Simulation simulation(scene, method, dt, run.config.time.steps);
  run.x.push_back(scene.x0);
  StepObserver nobody;
  const double start_s = now_s();
  for (int step = 0; step < run.config.time.steps; ++step) {
    options.limits().look_up(this_part, fmt::format("before its step {} of {}", step, run.config.time.steps));
    Prediction prediction;
    method.integrator->predict(simulation.history(), dt, prediction);
    Archive memory;
    simulation.step_system().keep(memory);
    const StepReport report = simulation.step(nobody);
    show(config, options, report, start_s);
    if (report.status != StepStatus::converged) {  // its state is in no balance: no load can be read from it
      run.stopped =
          fmt::format("the calibration run stopped at step {} with {}", step, to_string(report.status));
      if (!report.detail.empty()) run.stopped += ": " + report.detail;
      break;
    }
    run.x.push_back(simulation.history().x);
    run.c.push_back(prediction.c);
    run.memory.push_back(memory.bytes());
  }
  answer(run, scene, options);
  return cache.keep(std::move(run));
}

std::optional<double> policy_start(const RunConfig& config, const Scene& scene,
                                   const Calibration& calibration, const RunOptions& options) {
  RunConfig unscaled = config;
  unscaled.formulation.stiffness_policy.scale = 1;
  Method method = make_method(unscaled, calibration);
  Simulation simulation(scene, method, config.time.dt, config.time.steps);
  StepObserver nobody;
  const double start_s = now_s();
  while (simulation.nominal_steps() < config.time.steps) {
    options.limits().look_up(this_part, fmt::format("before step {} of {} to the first contact of the policy",
                                                    simulation.nominal_steps(), config.time.steps));
    const StepReport report = simulation.step(nobody);
    show(config, options, report, start_s);
    if (const double kappa = method.stiffness->state().kappa_start; kappa > 0) return kappa;
    if (report.status != StepStatus::converged) break;
  }
  return std::nullopt;
}

}  // namespace bb
