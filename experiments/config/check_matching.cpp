// What matching requires of a config: barriers that have the number it reads, and loads or a calibration run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/config/complain.hpp"
#include "experiments/config/policy_request.hpp"
#include "experiments/config/reader.hpp"

namespace bb {
namespace {

/// A barrier of which matching reads its slope at theta or its curvature at 1/2 of its width.
struct MatchedBarrier {
  const std::string& shape;
  Argument argument;
  double width;
  const char* load_pointer;
  std::optional<double> load;
  const PolicyConfig& policy;
  bool by_number;  // the rule supplies the policy's stiffness, and requires nothing of it
};

bool usable(double value) { return std::isfinite(value) && value > 0; }

void check_matched_barrier(const MatchingConfig& matching, const MatchedBarrier& m,
                           const Complain& complain) {
  const auto function = barrier_of(m.shape, m.argument);
  if (!function) return;  // it has a violation already
  const std::string name = fmt::format("{} on {}", m.shape, to_string(m.argument));
  if (matching.rule == MatchingRule::equal_curvature) {
    if (usable(function->eval(m.width / 2, m.width).d2b)) return;
    complain("/matching/rule", "\"equal_curvature\"",
             fmt::format("equal_force or as_given: b'' of {} is not > 0 at half its width", name));
    return;
  }
  const double slope = -function->eval(matching.theta * m.width, m.width).db;
  if (!usable(slope)) {
    complain("/matching/theta", fmt::format("{}", matching.theta),
             fmt::format("a value where b' of {} is finite and not 0", name));
  } else if (m.load && !usable(*m.load / slope)) {
    complain(m.load_pointer, fmt::format("{}", *m.load),
             fmt::format("a load that a stiffness of {} can be matched to", name));
  }
}

/// Without weight no calibration run can start: loads have to be given, and a policy that makes its own stiffness has
/// no record of the contact that carried them.
void check_calibration_run(const RunConfig& config, const MatchedBarrier& m, const Complain& complain) {
  if (largest_gravity(config.scene.gravity, config.scene.gravity_keys) > 0) return;
  if (!m.load) complain(m.load_pointer, "nothing", "a load: without gravity no calibration run can start");
  if (m.by_number) return;
  complain(
      "/matching/rule", fmt::format("\"{}\"", to_string(config.matching.rule)),
      fmt::format("as_given: policy {} is matched by a calibration run, and without gravity none can start",
                  m.policy.name));
}

/// False when no body of the scene can have a limited element.
bool may_be_limited(const RunConfig& config) {
  const auto& bodies = config.scene.bodies;
  return config.strain_limit.enabled &&
         (config.scene.name != "bodies" || std::any_of(bodies.begin(), bodies.end(), [](const BodyConfig& b) {
            return b.limited && b.spec.kind != BodyKind::rigid;
          }));
}

}  // namespace

void check_matching(const RunConfig& config, const Complain& complain) {
  if (config.matching.rule == MatchingRule::as_given) return;
  const FormulationConfig& contact = config.formulation;
  const StrainLimitConfig& limit = config.strain_limit;
  std::vector<MatchedBarrier> matched{{contact.shape, contact.argument, contact.d_hat, "/matching/load_N",
                                       config.matching.load, contact.stiffness_policy,
                                       needs_kappa(contact.stiffness_policy)}};
  if (may_be_limited(config)) {
    matched.push_back({limit.shape, limit.argument, limit.width, "/matching/limit_load_N_per_m",
                       config.matching.limit_load, limit.stiffness_policy,
                       needs_k_s(limit.stiffness_policy)});
  }
  const MatchedBarrier of_solids{limit.shape,
                                 limit.argument,
                                 limit.width,
                                 "/matching/solid_limit_load_Pa",
                                 config.matching.solid_limit_load,
                                 limit.stiffness_policy,
                                 true};
  if (config.matching.solid_limit_load) check_matched_barrier(config.matching, of_solids, complain);
  for (const MatchedBarrier& m : matched) {
    check_matched_barrier(config.matching, m, complain);
    check_calibration_run(config, m, complain);
  }
}

}  // namespace bb
