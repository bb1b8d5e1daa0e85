#include "experiments/run/pilot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/energy/strain_limit_batch.hpp"
#include "core/math/error.hpp"
#include "core/newton/simulation.hpp"
#include "experiments/config/parse.hpp"

namespace bb {
namespace {

/// Keeps the largest loads over converged states with the contact and the element that carried them.
class LoadObserver final : public StepObserver {
 public:
  explicit LoadObserver(const Scene& scene) : scene_(scene) {
    if (scene.limit.triangles.empty()) return;
    limit_.emplace(scene.limit.triangles, scene.rest, scene.limit.onset, scene.limit.width, scene.planar);
  }

  void on_step(NewtonSystem& system, const StepReport& step, const Positions& x) override {
    if (step.status != StepStatus::converged) return;
    if (step.force_max > loads.contact) {
      loads.contact = step.force_max;
      keep_row(system);
    }
    if (step.limit_tension_max > loads.limit) {
      loads.limit = step.limit_tension_max;
      keep_element(system, x);
    }
  }
  PilotLoads loads;

 private:
  void keep_row(NewtonSystem& system) {
    const ContactTable& rows = system.state().rows;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (-rows.kappa[r] * rows.db[r] < loads.contact) continue;
      loads.row =
          system.stiffness().columns(rows, static_cast<int>(r), system.blocks(), system.elastic_matrix());
      return;
    }
  }

  // k_s is the same everywhere in the pilot: the largest tension is where the gap to the limit is smallest.
  void keep_element(NewtonSystem& system, const Positions& x) {
    limit_->measure(x);
    const auto gaps = limit_->gaps();
    const auto e = static_cast<std::size_t>(std::min_element(gaps.begin(), gaps.end()) - gaps.begin()) / 2;
    const int* vertices = &limit_->vertices()[3 * e];
    LimitColumns& element = loads.element;
    for (int k = 0; k < 3; ++k) {
      element.x[k] = system.terms().x_n.col(vertices[k]);
      element.vertex_mass[k] = scene_.mass[static_cast<std::size_t>(vertices[k])];
    }
    Mat<double, 12, 12> block = Mat<double, 12, 12>::Zero();
    system.blocks().submatrix(system.elastic_matrix(), vertices, 3, block.data());
    element.hessian = block.topLeftCorner<9, 9>();
    element.element_mass = scene_.limit.mass[e];
    element.area = limit_->rests()[e].area;
  }

  const Scene& scene_;
  std::optional<StrainLimitBatch> limit_;
};

StaticLoads static_loads(const RunConfig& config, const Scene& scene) {
  double mass = 0;
  int n_free = 0;
  for (const double m : scene.mass) {
    mass += m;
    n_free += m > 0;
  }
  const double weight = mass * scene.gravity.norm();
  if (weight == 0) {
    throw ConfigError(config.source + "#/matching/load_N", "nothing",
                      "a load in N: the scene has no weight from which a pilot could start");
  }
  StaticLoads out;
  out.contact = weight / n_free;
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
  pilot.step_solver.name = "line_search";
  pilot.passes = {};
  return pilot;
}

Calibration pilot_stiffness(const RunConfig& pilot, const Scene& scene, const StaticLoads& loads) {
  Calibration out;
  out.limited = !scene.limit.triangles.empty();
  out.kappa = match_equal_force(log_barrier(), pilot.formulation.d_hat, loads.contact, 0.5);
  if (out.limited) {
    out.k_s = match_equal_force(log_barrier(), scene.limit.width.front(), loads.limit, 0.5);
  }
  return out;
}

void look_up(const RunOptions& options) {
  if (options.interrupted && options.interrupted->load()) throw Interrupted{};
}

void show(const RunConfig& config, const RunOptions& options, const StepReport& step) {
  if (!options.progress) return;
  Progress progress{run_label(config), "pilot", step.step + 1, config.time.steps};
  progress.newton = step.iterations;
  progress.contacts = step.contacts.total();
  progress.gap = step.gap_min;
  options.progress(progress);
}

}  // namespace

BarrierFunction log_barrier() { return {require_shape("log"), Argument::gap}; }

const PilotLoads& run_pilot(const RunConfig& config, const Scene& scene, const RunOptions& options) {
  static std::map<std::string, PilotLoads> known;
  const RunConfig pilot = pilot_config(config);
  const std::string id = config_id(pilot);
  if (const auto found = known.find(id); found != known.end()) return found->second;

  const StaticLoads rest = static_loads(config, scene);
  Method method = make_method(pilot, pilot_stiffness(pilot, scene, rest));
  method.keep_elastic_matrix = true;
  Simulation simulation(scene, method, pilot.time.dt, pilot.time.steps);
  LoadObserver observer(scene);
  observer.loads.rest = rest;
  for (int step = 0; step < pilot.time.steps; ++step) {
    look_up(options);
    const StepReport report = simulation.step(observer);
    show(config, options, report);
    if (report.status == StepStatus::converged) continue;
    observer.loads.stopped =
        fmt::format("the pilot stopped at step {} with {}", step, to_string(report.status));
    if (!report.detail.empty()) observer.loads.stopped += ": " + report.detail;
    break;
  }
  observer.loads.dt = pilot.time.dt;
  Prediction prediction;
  method.integrator->predict(simulation.history(), pilot.time.dt, prediction);
  observer.loads.c = prediction.c;
  observer.loads.config_id = id;
  return known.emplace(id, std::move(observer.loads)).first->second;
}

std::optional<double> policy_start(const RunConfig& config, const Scene& scene,
                                   const Calibration& calibration, const RunOptions& options) {
  RunConfig unscaled = config;
  unscaled.formulation.stiffness_policy.scale = 1;
  Method method = make_method(unscaled, calibration);
  Simulation simulation(scene, method, config.time.dt, config.time.steps);
  StepObserver nobody;
  for (int step = 0; step < config.time.steps; ++step) {
    look_up(options);
    const StepReport report = simulation.step(nobody);
    show(config, options, report);
    if (const double kappa = method.stiffness->state().kappa_start; kappa > 0) return kappa;
    if (report.status != StepStatus::converged) break;
  }
  return std::nullopt;
}

}  // namespace bb
