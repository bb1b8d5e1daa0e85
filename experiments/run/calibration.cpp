#include "experiments/run/calibration.hpp"

#include <fmt/format.h>

#include <cmath>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/barrier/slope_scan.hpp"
#include "core/math/error.hpp"
#include "experiments/config/policy_request.hpp"
#include "experiments/run/calibration_demand.hpp"

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
  std::shared_ptr<const CalibrationRun> calibration_run =
      nullptr;  // null: every load is given and nothing makes its own stiffness
};

/// s = matched stiffness / the policy's own.
double scale_of(double matched, double own, const char* what) {
  if (own > 0 && std::isfinite(matched / own)) return matched / own;
  throw ConfigError("matching", fmt::format("{} = {} where the policy starts", what, own),
                    "a stiffness > 0 there, or matching rule as_given");
}

bool has_one_kappa(const PolicyConfig& policy) {
  return !needs_kappa(policy) && make_contact_policy(policy, {})->needs_globals();
}

/// Adds why a policy stays as given.
void note(MatchingRecord& record, const std::string& why) {
  record.pilot_note += (record.pilot_note.empty() ? "" : "; ") + why;
}

/// Adds what was left out of the loads.
void note_left_out(MatchingRecord& record, const Demand& demand, const char* what, const char* unit) {
  if (demand.left_out == 0) return;
  note(record, fmt::format("{} {} forces are no loads, since they follow the stiffness of their barrier: the "
                           "largest is {:.3g} {} at {}, step {}",
                           demand.left_out, what, demand.left_out_load, unit, demand.left_out_where,
                           demand.left_out_step));
}

/// Why a policy that makes its own stiffness was not scaled: no contact gave its stiffness.
std::string why_as_given(const char* policy, const Demand& demand, const char* never) {
  return fmt::format("{} policy stays as given: {}", policy,
                     demand.left_out > 0 ? "no force of the calibration run is a load" : never);
}

/// The stiffness of the rule for a load and a width; a given load goes with a given width.
MatchedStiffness matched_stiffness(const Match& match, const BarrierFunction& barrier, double given_width) {
  return [match, &barrier, given_width](double load, double width) {
    Match one = match;
    if (match.load > 0) return one.stiffness(barrier, given_width);
    one.load = load;
    return one.stiffness(barrier, width);
  };
}

/// The policy that gives the contacts their own kappa; null where the stiffness is one number.
std::unique_ptr<StiffnessPolicy> asked_policy(const RunConfig& config) {
  PolicyConfig policy = config.formulation.stiffness_policy;
  if (needs_kappa(policy) || has_one_kappa(policy)) return nullptr;
  policy.scale = 1;  // the config's factor acts after matching, as it does on a fixed kappa
  return make_contact_policy(policy, {});
}

Demand ask_contacts(const Matching& m, const Match& match, const BarrierFunction& barrier) {
  if (!m.calibration_run || (m.config.matching.load && needs_kappa(m.config.formulation.stiffness_policy)))
    return {};
  const std::unique_ptr<StiffnessPolicy> policy = asked_policy(m.config);
  const Demand demand = contact_demand(*m.calibration_run, m.scene,
                                       matched_stiffness(match, barrier, m.config.formulation.d_hat),
                                       policy.get(), match.at(), m.options.limits());
  m.record.contacts_considered = demand.considered;
  m.record.contacts_left_out = demand.left_out;
  note_left_out(m.record, demand, "contact", "N");
  if (demand.left_out > 0) {
    m.record.left_out_contact = demand.left_out_where;
    m.record.left_out_N = demand.left_out_load;
  }
  if (demand.considered == 0) return demand;
  m.record.contact = demand.where;
  m.record.contact_step = demand.step;
  m.record.contact_answer = demand.answer;
  return demand;
}

void match_contact(const Matching& m, Calibration& out) {
  const MatchingConfig& matching = m.config.matching;
  const PolicyConfig& policy = m.config.formulation.stiffness_policy;
  const BarrierFunction barrier{require_shape(m.config.formulation.shape), m.config.formulation.argument};
  Match match{matching.rule, matching.theta, matching.load.value_or(0), matching.curvature};
  const Demand demand = ask_contacts(m, match, barrier);
  const bool measured = demand.considered > 0;
  double d_hat = m.config.formulation.d_hat;
  m.record.load_source = "given";
  if (!matching.load) {  // a measured load belongs to the contact that carried it, and so does the width
    m.record.load_source = measured ? "pilot" : "static_weight";
    match.load = measured ? demand.load : m.calibration_run->rest.contact;
    if (measured) d_hat = demand.width;
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
    return note(m.record, why_as_given("the contact", demand, "the calibration run met no contact"));
  }
  if (has_one_kappa(policy)) {
    const std::optional<double> start = policy_start(m.config, m.scene, out, m.options);
    if (!start) {
      return note(m.record, "the contact policy stays as given: its own run never reached a contact");
    }
    out.scale = scale_of(kappa, *start, "kappa");
  } else {
    out.scale = demand.largest;
  }
  m.record.scale = out.scale;
}

/// The same of the limit.
std::unique_ptr<StiffnessPolicy> asked_limit_policy(PolicyConfig policy) {
  if (needs_k_s(policy)) return nullptr;
  policy.scale = 1;
  return make_limit_policy(policy, {});
}

Demand ask_elements(const Matching& m, const Match& match, const BarrierFunction& barrier) {
  const PolicyConfig& policy = m.config.strain_limit.stiffness_policy;
  if (!m.calibration_run || (m.config.matching.limit_load && needs_k_s(policy))) return {};
  const std::unique_ptr<StiffnessPolicy> own = asked_limit_policy(policy);
  const MatchedStiffness matched = matched_stiffness(match, barrier, m.scene.limit.width.front());
  const Demand demand = limit_demand(*m.calibration_run, m.scene, matched, own.get(), m.options.limits());
  m.record.elements_considered = demand.considered;
  m.record.elements_left_out = demand.left_out;
  note_left_out(m.record, demand, "limit", "N/m");
  if (demand.left_out > 0) {
    m.record.left_out_element = demand.left_out_where;
    m.record.left_out_N_per_m = demand.left_out_load;
  }
  if (demand.considered == 0) return demand;
  m.record.limit_element = demand.where;
  m.record.limit_step = demand.step;
  m.record.limit_answer = demand.answer;
  return demand;
}

void match_limit(const Matching& m, Calibration& out) {
  const MatchingConfig& matching = m.config.matching;
  const BarrierFunction barrier{require_shape(m.config.strain_limit.shape), m.config.strain_limit.argument};
  Match match{matching.rule, matching.theta, matching.limit_load.value_or(0), matching.limit_curvature};
  const Demand demand = ask_elements(m, match, barrier);
  const bool measured = demand.considered > 0;
  double width = m.scene.limit.width.front();
  m.record.limit_load_source = "given";
  if (!matching.limit_load) {
    m.record.limit_load_source = measured ? "pilot" : "static_weight";
    match.load = measured ? demand.load : m.calibration_run->rest.limit;
    if (measured) width = demand.width;
  }
  m.record.limit_load_N_per_m = match.load;
  if (matching.rule == MatchingRule::equal_curvature) {
    m.record.limit_curvature = match.curvature_of_log(width);
  }
  if (needs_k_s(m.config.strain_limit.stiffness_policy)) {
    out.k_s = match.stiffness(barrier, width);
    m.record.limit_stiffness_N_per_m = *out.k_s;
  } else if (!measured) {
    note(m.record, why_as_given("the limit's", demand, "the limit was never active in the calibration run"));
  } else {
    out.limit_scale = demand.largest;
    m.record.limit_scale = out.limit_scale;
  }
}

/// k_s of solids for the load that is given; their policy stays as given where it makes its own kappa_e.
void match_solid_limit(const Matching& m, Calibration& out) {
  const MatchingConfig& matching = m.config.matching;
  const StrainLimitConfig& limit = m.config.strain_limit;
  if (!needs_k_s(limit.stiffness_policy)) {
    note(m.record,
         "the policy of the limit stays as given in solids: no calibration run measures their load");
    return;
  }
  if (matching.solid_limit_load) {
    const BarrierFunction barrier{require_shape(limit.shape), limit.argument};
    const Match match{matching.rule, matching.theta, *matching.solid_limit_load, std::nullopt};
    m.record.solid_limit_load_Pa = *matching.solid_limit_load;
    out.solid_k_s = match.stiffness(barrier, m.scene.solid_limit.width.front());
  } else {
    out.solid_k_s = limit.solid_k_s;
  }
  if (out.solid_k_s) m.record.solid_limit_stiffness_Pa = *out.solid_k_s;
}

/// Whether a load is missing, or a policy has to be evaluated at the contacts or elements that carried it.
bool needs_calibration_run(const RunConfig& config, bool limited) {
  const bool contact = !config.matching.load || !needs_kappa(config.formulation.stiffness_policy);
  const bool limit = !config.matching.limit_load || !needs_k_s(config.strain_limit.stiffness_policy);
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
    if (const auto kappa = given_kappa(policy)) record.kappa_N_per_m = *kappa;
    const std::optional<double> k_s = given_k_s(config.strain_limit.stiffness_policy);
    if (out.limited && k_s) record.limit_stiffness_N_per_m = *k_s;
    if (config.strain_limit.solid_k_s) record.solid_limit_stiffness_Pa = *config.strain_limit.solid_k_s;
    return out;
  }
  record.theta = config.matching.theta;
  Matching matching{config, scene, options, record};
  if (needs_calibration_run(config, out.limited)) {
    matching.calibration_run = run_calibration(config, scene, options);
    record.pilot_config_id = matching.calibration_run->config_id;
    record.pilot_note = matching.calibration_run->stopped;
    if (const int steps = matching.calibration_run->unanswered; steps > 0)
      note(record, fmt::format("of {} steps it is not known which forces are loads: all count", steps));
  }
  if (!scene.solid_limit.tetrahedra.empty()) match_solid_limit(matching, out);
  if (out.limited) match_limit(matching, out);  // first: the contact's policy may have to be followed
  match_contact(matching, out);
  return out;
}

}  // namespace bb
