#include "experiments/run/pilot.hpp"

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
#include "experiments/run/pilot_replay.hpp"
#include "experiments/run/plan.hpp"

namespace bb {
namespace {

constexpr const char* this_part = "pilot";

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
                      "a load in N: the scene has no weight from which a pilot could start");
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

// The pilot: log on the gap for contact and limit, kappa putting the static weight per contact at d_hat/2
// (the limit: the weight per width at width/2). Everything else is the config's own.
RunConfig pilot_config(const RunConfig& config) {
  RunConfig pilot = config;
  pilot.formulation.name = "log";
  pilot.formulation.shape = "log";
  pilot.formulation.argument = Argument::gap;
  pilot.formulation.stiffness_policy = {};
  pilot.strain_limit.shape = "log";
  pilot.strain_limit.argument = Argument::gap;
  pilot.strain_limit.stiffness_policy = {};
  pilot.matching = {};
  pilot.strain_limit.solid_k_s.reset();  // that of its own log
  pilot.step_solver.name = "line_search";
  pilot.step_solver.saddle = SaddleRule::escape;  // loads are those of minima
  pilot.step_solver.retries = 0;                  // its steps are all as long as those that read its loads
  pilot.time.step_size.reset(), pilot.time.step_iterations.reset();
  pilot.time.step_halvings.reset(), pilot.time.step_error.reset();
  pilot.output.checkpoint_every = 0;  // it has no folder
  pilot.passes = {};
  pilot.precision = Precision::full;  // what is compared between precisions has one stiffness
  if (pilot.device != Device::cpu) {  // and between devices
    pilot.device = Device::cpu;
    pilot.linear_solver = {};
  }
  return pilot;
}

Calibration pilot_stiffness(const RunConfig& pilot, const Scene& scene, const StaticLoads& loads) {
  Calibration out;
  out.limited = !scene.limit.triangles.empty();
  out.kappa = match_equal_force(log_barrier(), pilot.formulation.d_hat, loads.contact, 0.5);
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
  progress.pass = "pilot";
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
void add_answers(const Pilot& pilot, const StiffnessAnswers& answers, const ContactTable& rows,
                 LimitFamily* limit, const Scene& scene, const Positions& x, AnswerSums& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) out.add_contact(rows, r, -rows.force(r), answers.contact[r]);
  if (!limit) return;
  limit->measure(x.data());
  for (std::size_t e = 0; e < scene.limit.width.size(); ++e) {
    const double y = limit->smallest_gap(e), width = scene.limit.width[e];
    if (y < width)
      out.add_limit(e, -*pilot.stiffness.k_s * log_barrier().eval(y, width).db, answers.limit[e]);
  }
}

// How the forces at the ends of all steps answer to stiffness.
void answer(Pilot& pilot, const Scene& scene, const RunOptions& options) {
  const StrainLimitPart& part = scene.limit;
  exec::HostExecutor executor;
  std::unique_ptr<LimitFamily> limit;
  if (!part.triangles.empty()) limit = limited_triangles({executor}, part, scene.rest, scene.planar);
  PilotReplay replay(pilot, scene);
  pilot.answers = AnswerSums(scene.n_vertices(), part.triangles.size());
  for (int step = 0; step < pilot.steps(); ++step) {
    options.limits().look_up(
        this_part, fmt::format("while the forces of its step {} of {} were read", step, pilot.steps()));
    const StiffnessAnswers answers =
        answers_to_stiffness(replay.assembled(step), limit.get(), log_barrier(), pilot.config.time.dt);
    pilot.unanswered += answers.known ? 0 : 1;
    add_answers(pilot, answers, replay.rows(), limit.get(), scene, replay.end(step), pilot.answers);
  }
}

}  // namespace

std::size_t Pilot::bytes() const {
  const std::size_t states = x.empty() ? 0 : x.size() * static_cast<std::size_t>(x[0].size());
  std::size_t remembered = 0;
  for (const std::string& archive : memory) remembered += archive.size();
  return states * sizeof(double) + remembered + answers.bytes();
}

BarrierFunction log_barrier() { return {require_shape("log"), Argument::gap}; }

std::shared_ptr<const Pilot> PilotCache::find(const std::string& config_id) {
  const auto found = std::find_if(known_.begin(), known_.end(),
                                  [&](const auto& pilot) { return pilot->config_id == config_id; });
  if (found == known_.end()) return nullptr;
  std::rotate(found, std::next(found), known_.end());
  return known_.back();
}

std::shared_ptr<const Pilot> PilotCache::keep(Pilot pilot) {
  known_.push_back(std::make_shared<const Pilot>(std::move(pilot)));
  std::size_t total = 0, first = known_.size();
  while (first > 0 && (first == known_.size() || total + known_[first - 1]->bytes() <= bytes_)) {
    total += known_[--first]->bytes();
  }
  known_.erase(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(first));
  return known_.back();
}

std::shared_ptr<const Pilot> run_pilot(const RunConfig& config, const Scene& given,
                                       const RunOptions& options) {
  static PilotCache cache(std::size_t{256} << 20);
  Pilot pilot;
  pilot.config = pilot_config(config);
  pilot.config_id = config_id(pilot.config);
  if (auto known = cache.find(pilot.config_id)) return known;

  // a scene whose start was rounded to float would leave other loads, in whatever run of a sweep came first
  const Scene unrounded = values_in_float(config.precision) ? build_scene(pilot.config) : Scene();
  const Scene& scene = values_in_float(config.precision) ? unrounded : given;
  const double dt = pilot.config.time.dt;
  pilot.rest = static_loads(config, scene);
  pilot.stiffness = pilot_stiffness(pilot.config, scene, pilot.rest);
  Method method = make_method(pilot.config, pilot.stiffness);
  Simulation simulation(scene, method, dt, pilot.config.time.steps);
  pilot.x.push_back(scene.x0);
  StepObserver nobody;
  const double start_s = now_s();
  for (int step = 0; step < pilot.config.time.steps; ++step) {
    options.limits().look_up(this_part,
                             fmt::format("before its step {} of {}", step, pilot.config.time.steps));
    Prediction prediction;
    method.integrator->predict(simulation.history(), dt, prediction);
    Archive memory;
    simulation.step_system().keep(memory);
    const StepReport report = simulation.step(nobody);
    show(config, options, report, start_s);
    if (report.status != StepStatus::converged) {  // its state is in no balance: no load can be read from it
      pilot.stopped = fmt::format("the pilot stopped at step {} with {}", step, to_string(report.status));
      if (!report.detail.empty()) pilot.stopped += ": " + report.detail;
      break;
    }
    pilot.x.push_back(simulation.history().x);
    pilot.c.push_back(prediction.c);
    pilot.memory.push_back(memory.bytes());
  }
  answer(pilot, scene, options);
  return cache.keep(std::move(pilot));
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
