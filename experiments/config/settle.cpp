// Time, the formulation, the strain limit and the matching rule: defaults that follow other settings, and settings
// that exclude each other.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "barriers/formulas.hpp"
#include "barriers/matching.hpp"
#include "core/base/input/names.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/methods.hpp"
#include "experiments/config/policy_request.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/sections.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// Leaves the policy with its own parameters; complains of given ones that only other policies read.
template <class Entry>
void keep_own(const json& object, const Registry<Entry>& registry, const std::string& pointer,
              const Reader& reader, PolicyConfig& policy) {
  const Entry& entry = registry.require(policy.name, pointer);
  policy.parameters = to_map(entry.parameters, object);
  for (const auto& [key, value] : object.items()) {
    if (!reader.complete || key == "name" || key == "scale" || find_named(entry.parameters, key)) continue;
    reader.complain(fmt::format("{}/{}", pointer, key), value.dump(),
                    fmt::format("nothing: the policy {} does not read it", policy.name));
  }
}

/// The formula of a policy gets the one spelling of its tree. What is no formula stays, and is refused by the policy.
void spell_formula(PolicyConfig& policy) {
  const auto given = policy.parameters.find("formula");
  if (given == policy.parameters.end() || given->second == ParameterValue(no_default)) return;
  try {
    given->second = require_policy_formula(text(policy.parameters, "formula"), "").formula;
  } catch (const ConfigError&) {
  }
}

/// A published constant becomes the kappa that it means.
void convert_kappa(const json& object, const std::string& pointer, const Reader& reader,
                   const FormulationConfig& formulation, PolicyConfig& policy) {
  std::string used = object.contains("kappa_N_per_m") ? "kappa_N_per_m" : "";
  for (const KappaConvention& convention : kappa_conventions()) {
    const std::optional<double> constant = optional_number(policy.parameters, convention.name);
    policy.parameters.erase(convention.name);
    if (!constant) continue;
    const std::string where = pointer + "/" + convention.name, found = object[convention.name].dump();
    if (!used.empty()) {
      reader.complain(where, found, "nothing: " + used + " is given too");
    } else if ((!convention.shape.empty() && formulation.shape != convention.shape) ||
               to_string(formulation.argument) != convention.argument) {
      reader.complain(where, found,
                      fmt::format("kappa_N_per_m: this convention goes with {}argument {}",
                                  convention.shape.empty() ? "" : "shape " + convention.shape + " and ",
                                  convention.argument));
    } else {
      policy.parameters["kappa_N_per_m"] = convention.kappa(*constant, formulation.d_hat);
    }
    used = convention.name;
  }
}

/// The limit follows the contact's policy where it has it, with all its settings.
json followed(const json& object, const PolicyConfig& contact) {
  const StiffnessPolicyEntry* same = limit_policies().find(contact.name);
  const bool another = object.contains("name") && object["name"] != contact.name;
  if (same == nullptr || !same->matched.empty() || another) return object;
  json out = to_json(contact.parameters);
  if (out.value("mass_term", "") == "none") out["mass_term"] = "inertia";  // a limit needs a mass
  out["name"] = contact.name;
  out.update(object);
  return out;
}

/// True when a limit was found; onset and width are then set.
bool settle_width(const json& object, const Reader& reader, std::optional<double> fallback,
                  StrainLimitConfig& out) {
  const bool onset = object.contains("onset"), width = object.contains("width");
  if (object.contains("limit") && (onset || width)) {
    reader.complain("/strain_limit/limit", object["limit"].dump(), "either limit, or onset and width");
  } else if (onset != width) {
    reader.missing(onset ? "/strain_limit/width" : "/strain_limit/onset", "onset and width together");
  }
  const std::optional<double> bare = object.contains("limit") ? out.limit : fallback;
  out.limit.reset();
  if (onset && width) return true;
  if (bare) out.onset = out.width = *bare / 2;
  return bare.has_value();
}

}  // namespace

void settle_friction(const json& object, RunConfig& config) {
  if (config.method.empty() || !has_friction(config)) return;
  json all = friction_of_method(config.method);
  all.update(object);
  config.friction = FrictionConfig();
  settings_of<FrictionConfig>().read(all, config.friction);
}

void settle_time(const json& object, const Reader& reader, TimeConfig& out) {
  if (!out.duration) return;
  constexpr double most = 1e9, rounding = 1e-9;  // 0.4 s are 400 steps of 1e-3 s
  const double steps = std::max(1.0, std::ceil(*out.duration / out.dt * (1 - rounding)));
  if (!(steps <= most)) {
    reader.complain("/time/duration_s", json(*out.duration).dump(),
                    fmt::format("at most {} steps of dt_s", most));
    return;
  }
  if (object.contains("steps") && out.steps != steps) {
    reader.complain(
        "/time/steps", fmt::format("{}", out.steps),
        fmt::format("{}, which is ceil(duration_s/dt_s), or only one of steps and duration_s", steps));
  }
  out.steps = static_cast<int>(steps);
}

void settle_formulation(const json& object, const Reader& reader, FormulationConfig& out) {
  if (object.contains("name")) {
    check_plain_name(reader.source + "#/formulation/name", object["name"].get<std::string>(),
                     reader.violations);
  }
  if (out.name.empty() && is_formula(out.shape)) {  // a name for folders and legends, as short as others
    out.name = formula_libraries({out.shape}).front().label;
  }
  const std::string pointer = "/formulation/stiffness_policy";
  const json& policy = child(object, "stiffness_policy");
  keep_own(policy, stiffness_policies(), pointer, reader, out.stiffness_policy);
  spell_formula(out.stiffness_policy);
  convert_kappa(policy, pointer, reader, out, out.stiffness_policy);
}

void settle_strain_limit(const json& object, const Reader& reader, const FormulationConfig& formulation,
                         std::optional<double> default_limit, StrainLimitConfig& out) {
  if (!object.contains("shape")) out.shape = formulation.shape;
  if (!object.contains("argument")) out.argument = formulation.argument;
  const json policy = followed(child(object, "stiffness_policy"), formulation.stiffness_policy);
  out.stiffness_policy.name = policy.value("name", out.stiffness_policy.name);
  keep_own(policy, limit_policies(), "/strain_limit/stiffness_policy", reader, out.stiffness_policy);
  const bool has_limit = settle_width(object, reader, default_limit, out);
  if (!object.contains("enabled")) out.enabled = has_limit;
  if (out.enabled && !has_limit) {
    reader.missing("/strain_limit/limit",
                   "a number > 0 and <= 10, or onset and width: this scene has no default");
  }
}

/// What only a rule that matches forces reads.
constexpr std::array loads = {"theta", "load_N", "limit_load_N_per_m", "solid_limit_load_Pa"};

void settle_matching(const json& object, const Reader& reader, bool literal, RunConfig& config) {
  const PolicyConfig& contact = config.formulation.stiffness_policy;
  const PolicyConfig& limit = config.strain_limit.stiffness_policy;
  const bool contact_given = !needs_kappa(contact) || given_kappa(contact);
  const bool limit_given = !config.strain_limit.enabled || !needs_k_s(limit) || given_k_s(limit);
  const bool of_solids = limits_solids(config.strain_limit) && needs_k_s(limit);
  const bool solid_given = !of_solids || config.strain_limit.solid_k_s;
  const bool as_given = literal || (contact_given && limit_given && solid_given);
  MatchingConfig& out = config.matching;
  // A preset has a stiffness of its own: a key that only matching reads requests matching.
  const bool asked = !literal && std::any_of(loads.begin(), loads.end(),
                                             [&object](const char* key) { return object.contains(key); });
  if (!object.contains("rule"))
    out.rule = as_given && !asked ? MatchingRule::as_given : MatchingRule::equal_force;
  if (out.rule != MatchingRule::equal_curvature) {
    for (const char* key : {"curvature_N_per_m", "limit_curvature_N_per_m"}) {
      if (!object.contains(key)) continue;
      reader.complain(std::string("/matching/") + key, object[key].dump(),
                      std::string("nothing: the rule is ") + to_string(out.rule));
    }
  }
  if (out.rule != MatchingRule::as_given) {
    if (!solid_given && !out.solid_limit_load)
      reader.missing("/matching/solid_limit_load_Pa",
                     "a load > 0 (Pa) of the strain limit of solids, which no calibration run measures, or "
                     "/strain_limit/solid_k_s_Pa");
    return;
  }
  if (!solid_given)
    reader.missing("/strain_limit/solid_k_s_Pa",
                   "a number > 0 (Pa), or matching rule equal_force and solid_limit_load_Pa");
  if (!contact_given)
    reader.missing("/formulation/stiffness_policy/kappa_N_per_m",
                   "a number > 0 (N/m), or matching rule equal_force");
  if (!limit_given) {
    reader.missing("/strain_limit/stiffness_policy/k_s_N_per_m",
                   "a number > 0 (N/m), or matching rule equal_force");
  }
}

}  // namespace bb
