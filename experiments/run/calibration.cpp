#include "experiments/run/calibration.hpp"

#include <fmt/format.h>

#include <cmath>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/contact/slope_scan.hpp"
#include "core/math/error.hpp"
#include "experiments/config/policy_request.hpp"

namespace bb {
namespace {

/// The load or curvature of one barrier (contact or limit) as the rule wants it.
struct Match {
  MatchingRule rule;
  double theta;
  double load;                      // N or N/m
  std::optional<double> curvature;  // given; otherwise that of the matched log

  /// Gap in units of the width at which formulations agree.
  double at() const { return rule == MatchingRule::equal_force ? theta : 0.5; }

  double curvature_of_log(double width) const {
    if (curvature) return *curvature;
    const BarrierFunction log = log_barrier();
    return match_equal_force(log, width, load, theta) * log.eval(width / 2, width).d2b;
  }
  double stiffness(const BarrierFunction& barrier, double width) const {
    return rule == MatchingRule::equal_force ? match_equal_force(barrier, width, load, theta)
                                             : match_equal_curvature(barrier, width, curvature_of_log(width));
  }
};

/// What `calibrate` collects on its way.
struct Matching {
  const RunConfig& config;
  const Scene& scene;
  const RunOptions& options;
  MatchingRecord& record;
  const PilotLoads* pilot = nullptr;  // null: every load is given and nothing makes its own stiffness
};

/// s = matched stiffness / the policy's own.
double scale_of(double matched, double own, const char* what) {
  if (own > 0 && std::isfinite(matched / own)) return matched / own;
  throw ConfigError("matching", fmt::format("{} = {} where the pilot's largest load was carried", what, own),
                    "a stiffness > 0 there, or matching rule as_given");
}

/// kappa that the config's own policy gives the contact that carried the load, at a gap of u of that
/// contact's d_hat. The factor `scale` of the config acts after matching, as it does on a fixed kappa.
double kappa_of_row(const RunConfig& config, const PilotLoads& pilot, double u) {
  PolicyConfig policy = config.formulation.stiffness_policy;
  policy.scale = 1;
  PolicyColumns row = pilot.row;
  row.d[0] = u * row.d_hat[0];
  double kappa = 0;
  make_contact_policy(policy, {})->fill(row.batch(pilot.dt, pilot.c, !row.hessian.empty()), &kappa);
  return kappa;
}

/// kappa_e (J) that the config's limit policy gives the element that carried the load, at a gap of u widths.
double kappa_of_element(const RunConfig& config, const PilotLoads& pilot, double width, double u) {
  const LimitStiffness limit = make_limit_policy(config.strain_limit.stiffness_policy, {});
  const LimitColumns& e = pilot.element;
  const StrainStiffnessRule rule = limit.rule(pilot.dt, pilot.c);
  return strain_stiffness<double>(e.x, e.hessian, e.vertex_mass, e.element_mass, u * width, rule);
}

bool has_one_kappa(const PolicyConfig& policy) {
  return !needs_kappa(policy) && make_contact_policy(policy, {})->needs_globals();
}

/// Adds why a policy stays as given.
void note(MatchingRecord& record, const char* why) {
  record.pilot_note += (record.pilot_note.empty() ? "" : "; ") + std::string(why);
}

void match_contact(const Matching& m, Calibration& out) {
  const MatchingConfig& matching = m.config.matching;
  const PolicyConfig& policy = m.config.formulation.stiffness_policy;
  const BarrierFunction barrier{require_shape(m.config.formulation.shape), m.config.formulation.argument};
  const bool measured = m.pilot && m.pilot->contact > 0;
  Match match{matching.rule, matching.theta, matching.load.value_or(0), matching.curvature};
  double d_hat = m.config.formulation.d_hat;
  m.record.load_source = "given";
  if (!matching.load) {  // a measured load belongs to the contact that carried it, and so does the width
    m.record.load_source = measured ? "pilot" : "static_weight";
    match.load = measured ? m.pilot->contact : m.pilot->rest.contact;
    if (measured) d_hat = m.pilot->row.d_hat[0];
  }
  m.record.load_N = match.load;
  m.record.d_hat_m = d_hat;
  if (matching.rule == MatchingRule::equal_curvature) {
    m.record.curvature_N_per_m = match.curvature_of_log(d_hat);
  }
  const double kappa = match.stiffness(barrier, d_hat);
  if (needs_kappa(policy)) {
    out.kappa = kappa;
    m.record.kappa_N_per_m = kappa;
    if (const auto slope = max_slope(barrier, d_hat)) m.record.capacity_N = kappa * *slope;
    return;
  }
  if (!measured) {
    return note(m.record, "the contact policy stays as given: the pilot met no contact");
  }
  if (has_one_kappa(policy)) {
    const std::optional<double> start = policy_start(m.config, m.scene, out, m.options);
    if (!start) {
      return note(m.record, "the contact policy stays as given: its own run never reached a contact");
    }
    out.scale = scale_of(kappa, *start, "kappa");
  } else {
    out.scale = scale_of(kappa, kappa_of_row(m.config, *m.pilot, match.at()), "kappa");
  }
  m.record.scale = out.scale;
}

void match_limit(const Matching& m, Calibration& out) {
  const MatchingConfig& matching = m.config.matching;
  const BarrierFunction barrier{require_shape(m.config.strain_limit.shape), m.config.strain_limit.argument};
  const bool measured = m.pilot && m.pilot->limit > 0;
  const double width = m.scene.limit.width.front();
  Match match{matching.rule, matching.theta, matching.limit_load.value_or(0), matching.limit_curvature};
  m.record.limit_load_source = "given";
  if (!matching.limit_load) {
    m.record.limit_load_source = measured ? "pilot" : "static_weight";
    match.load = measured ? m.pilot->limit : m.pilot->rest.limit;
  }
  m.record.limit_load_N_per_m = match.load;
  if (matching.rule == MatchingRule::equal_curvature) {
    m.record.limit_curvature = match.curvature_of_log(width);
  }
  const double k_s = match.stiffness(barrier, width);
  if (needs_kappa(m.config.strain_limit.stiffness_policy)) {
    out.k_s = k_s;
    m.record.limit_stiffness_N_per_m = k_s;
  } else if (!measured) {
    note(m.record, "the limit's policy stays as given: the limit was never active in the pilot");
  } else {
    const double own = kappa_of_element(m.config, *m.pilot, width, match.at());
    out.limit_scale = scale_of(k_s * m.pilot->element.area, own, "kappa_e");
    m.record.limit_scale = out.limit_scale;
  }
}

/// Whether a load is missing, or a policy has to be asked about the contact or element that carried it.
bool needs_pilot(const RunConfig& config, bool limited) {
  const bool contact = !config.matching.load || !needs_kappa(config.formulation.stiffness_policy);
  const bool limit = !config.matching.limit_load || !needs_kappa(config.strain_limit.stiffness_policy);
  return contact || (limited && limit);
}

}  // namespace

Calibration calibrate(const RunConfig& config, const Scene& scene, const RunOptions& options,
                      MatchingRecord& record) {
  const MatchingRule rule = config.matching.rule;
  Calibration out;
  out.limited = !scene.limit.triangles.empty();
  record.rule = to_string(rule);
  if (rule == MatchingRule::as_given) {
    const PolicyConfig& policy = config.formulation.stiffness_policy;
    if (needs_kappa(policy) && policy.kappa) record.kappa_N_per_m = *policy.kappa;
    const std::optional<double>& k_s = config.strain_limit.stiffness_policy.k_s;
    if (out.limited && k_s) record.limit_stiffness_N_per_m = *k_s;
    return out;
  }
  record.theta = config.matching.theta;
  Matching matching{config, scene, options, record};
  if (needs_pilot(config, out.limited)) {
    matching.pilot = &run_pilot(config, scene, options);
    record.pilot_config_id = matching.pilot->config_id;
    record.pilot_note = matching.pilot->stopped;
  }
  if (out.limited) match_limit(matching, out);  // first: the contact's policy may have to be followed
  match_contact(matching, out);
  return out;
}

}  // namespace bb
