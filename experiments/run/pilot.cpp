#include "experiments/run/pilot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/math/error.hpp"
#include "core/newton/simulation.hpp"
#include "experiments/config/parse.hpp"

namespace bb {
namespace {

/// What the weight alone asks for: the pilot starts from it, and it stands in where the pilot found nothing.
struct StaticLoads {
  double contact = 0;  // N per free vertex
  double limit = 0;    // N/m, weight over the side of a square of the limited area; 0 without a limit
};

/// What the pilot leaves: largest loads over converged states, and the contact that carried the largest.
struct Loads {
  double contact = 0;  // N, kappa |b'| per unit multiplicity
  double limit = 0;    // N/m
  StaticLoads rest;
  double dt = 0, c = 1;
  PolicyColumns columns;  // of that contact
  std::string config_id;
  std::string stopped;  // why it ended early; empty when it did not
};

class LoadObserver final : public StepObserver {
 public:
  void on_step(NewtonSystem& system, const StepReport& step, const Positions&) override {
    if (step.status != StepStatus::converged) return;
    loads.limit = std::max(loads.limit, step.limit_tension_max);
    if (step.force_max <= loads.contact) return;
    loads.contact = step.force_max;
    const ContactTable& rows = system.state().rows;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (-rows.kappa[r] * rows.db[r] < step.force_max) continue;
      loads.columns =
          system.stiffness().columns(rows, static_cast<int>(r), system.blocks(), system.elastic_matrix());
      break;
    }
  }
  Loads loads;
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
  const BarrierFunction log{require_shape("log"), Argument::gap};
  Calibration out;
  out.kappa = match_equal_force(log, pilot.formulation.d_hat, loads.contact, 0.5);
  if (loads.limit > 0) out.k_s = match_equal_force(log, scene.limit.width.front(), loads.limit, 0.5);
  return out;
}

const Loads& run_pilot(const RunConfig& config, const Scene& scene, const RunOptions& options) {
  static std::map<std::string, Loads> known;
  const RunConfig pilot = pilot_config(config);
  const std::string id = config_id(pilot);
  if (const auto found = known.find(id); found != known.end()) return found->second;

  const StaticLoads rest = static_loads(config, scene);
  Method method = make_method(pilot, pilot_stiffness(pilot, scene, rest));
  method.keep_elastic_matrix = true;
  Simulation simulation(scene, method, pilot.time.dt, pilot.time.steps);
  LoadObserver observer;
  observer.loads.rest = rest;
  for (int step = 0; step < pilot.time.steps; ++step) {
    if (options.interrupted && options.interrupted->load()) throw Interrupted{};
    const StepReport report = simulation.step(observer);
    if (options.progress) {
      Progress progress{run_label(config), "pilot", step + 1, pilot.time.steps};
      progress.newton = report.iterations;
      progress.contacts = report.contacts.total();
      progress.gap = report.gap_min;
      options.progress(progress);
    }
    if (report.status == StepStatus::converged) continue;
    observer.loads.stopped =
        fmt::format("the pilot stopped at step {} with {} {}", step, to_string(report.status), report.detail);
    break;
  }
  observer.loads.dt = pilot.time.dt;
  Prediction prediction;
  method.integrator->predict(simulation.history(), pilot.time.dt, prediction);
  observer.loads.c = prediction.c;
  observer.loads.config_id = id;
  return known.emplace(id, std::move(observer.loads)).first->second;
}

/// The load or curvature of one barrier (contact or limit) as the rule wants it.
struct Match {
  MatchingRule rule;
  double theta;
  double load;                      // N or N/m
  std::optional<double> curvature;  // given; otherwise that of the matched log

  double curvature_of_log(double width) const {
    if (curvature) return *curvature;
    const BarrierFunction log{require_shape("log"), Argument::gap};
    return match_equal_force(log, width, load, theta) * log.eval(width / 2, width).d2b;
  }
  double stiffness(const BarrierFunction& barrier, double width) const {
    return rule == MatchingRule::equal_force ? match_equal_force(barrier, width, load, theta)
                                             : match_equal_curvature(barrier, width, curvature_of_log(width));
  }
};

// kappa that the config's own policy would give the contact that carried the load, at d = theta d_hat.
double policy_kappa(const RunConfig& config, const Loads& loads, double theta) {
  Method method = make_method(config, {});
  if (method.stiffness->needs_globals()) {
    throw ConfigError(config.source + "#/matching/rule",
                      "a policy with one global kappa: " + config.formulation.stiffness_policy.name,
                      "as_given");
  }
  PolicyColumns columns = loads.columns;
  columns.d[0] = theta * columns.d_hat[0];
  double kappa = 0;
  method.stiffness->fill(columns.batch(loads.dt, loads.c, !columns.hessian.empty()), &kappa);
  return kappa;
}

}  // namespace

Calibration calibrate(const RunConfig& config, const Scene& scene, const RunOptions& options,
                      MatchingRecord& record) {
  const MatchingConfig& matching = config.matching;
  Calibration out;
  const PolicyConfig& policy = config.formulation.stiffness_policy;
  const bool limited = !scene.limit.triangles.empty();
  record.rule = matching.rule == MatchingRule::as_given      ? "as_given"
                : matching.rule == MatchingRule::equal_force ? "equal_force"
                                                             : "equal_curvature";
  if (matching.rule == MatchingRule::as_given) {
    if (needs_kappa(policy) && policy.kappa) record.kappa_N_per_m = *policy.kappa;
    if (limited && config.strain_limit.stiffness_policy.k_s) {
      record.limit_stiffness_N_per_m = *config.strain_limit.stiffness_policy.k_s;
    }
    return out;
  }

  record.theta = matching.theta;
  double load = matching.load.value_or(0), limit_load = matching.limit_load.value_or(0);
  record.load_source = "given";
  const Loads* pilot = nullptr;
  if (load == 0 || (limited && limit_load == 0) || !needs_kappa(policy)) {
    pilot = &run_pilot(config, scene, options);
    record.pilot_run_id = pilot->config_id;
    record.pilot_note = pilot->stopped;
    if (load == 0) record.load_source = pilot->contact > 0 ? "pilot" : "static_weight";
    if (load == 0) load = pilot->contact > 0 ? pilot->contact : pilot->rest.contact;
    if (limit_load == 0) limit_load = pilot->limit > 0 ? pilot->limit : pilot->rest.limit;
  }
  record.load_N = load;

  const BarrierFunction contact{require_shape(config.formulation.shape), config.formulation.argument};
  const double d_hat = config.formulation.d_hat;
  const Match match{matching.rule, matching.theta, load, matching.curvature};
  if (matching.rule == MatchingRule::equal_curvature)
    record.curvature_N_per_m = match.curvature_of_log(d_hat);
  if (needs_kappa(policy)) {
    out.kappa = match.stiffness(contact, d_hat);
    record.kappa_N_per_m = *out.kappa;
    if (const auto slope = max_slope(contact, d_hat)) record.capacity_N = *out.kappa * *slope;
  } else if (pilot->contact > 0) {  // without a contact that carried a load, a policy stays as given
    out.scale = match_policy_scale(contact, d_hat, load, policy_kappa(config, *pilot, matching.theta),
                                   matching.theta);
    record.scale = out.scale;
  }
  if (limited && needs_kappa(config.strain_limit.stiffness_policy)) {
    const BarrierFunction limit{require_shape(config.strain_limit.shape), config.strain_limit.argument};
    const double width = scene.limit.width.front();
    const Match limit_match{matching.rule, matching.theta, limit_load, matching.limit_curvature};
    if (matching.rule == MatchingRule::equal_curvature)
      record.limit_curvature = limit_match.curvature_of_log(width);
    record.limit_load_N_per_m = limit_load;
    out.k_s = limit_match.stiffness(limit, width);
    record.limit_stiffness_N_per_m = *out.k_s;
  }
  return out;
}

}  // namespace bb
