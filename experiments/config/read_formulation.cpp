// The formulation, the strain limit and the matching rule.
#include <fmt/format.h>

#include "barriers/matching.hpp"
#include "barriers/named_entries.hpp"
#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/input/names.hpp"
#include "experiments/config/reader.hpp"

namespace bb {
namespace {

using nlohmann::json;

std::string read_shape(const json& object, const std::string& fallback, const std::string& pointer,
                       const Reader& reader) {
  const std::string name = object.value("shape", fallback);
  if (object.contains("shape") && !find_shape(name))  // a wrong fallback was complained of where it stands
    reader.take(unknown_name(reader.source + "#" + pointer + "/shape", name, entry_names(shapes())));
  return name;
}

/// A published convention of a fixed kappa, and the formulation it was published for.
struct Convention {
  const char* key;
  const char* shape;  // null: any
  const char* argument;
};
constexpr Convention conventions[] = {{"kappa_N_per_m", nullptr, nullptr},
                                      {"kappa_a_J", "cubic", "gap"},
                                      {"kappa_p_N", "quadratic", "gap"},
                                      {"kappa_ipc_N_per_m3", nullptr, "squared_gap"}};

void read_kappa(const json& object, const std::string& pointer, const Reader& reader,
                const FormulationConfig& formulation, PolicyConfig& policy) {
  std::string used;
  for (const Convention& convention : conventions) {
    if (!object.contains(convention.key)) continue;
    const std::string where = pointer + "/" + convention.key, found = object[convention.key].dump();
    if (policy.name != "fixed") {
      reader.complain(where, found,
                      "nothing: only the policy fixed takes a kappa, this one is " + policy.name);
    } else if (!used.empty()) {
      reader.complain(where, found, "nothing: " + used + " is given too");
    } else if ((convention.shape && formulation.shape != convention.shape) ||
               (convention.argument && to_string(formulation.argument) != convention.argument)) {
      reader.complain(where, found,
                      fmt::format("kappa_N_per_m: this convention goes with {}{}{}",
                                  convention.shape ? std::string("shape ") + convention.shape : "",
                                  convention.shape && convention.argument ? " and " : "",
                                  convention.argument ? std::string("argument ") + convention.argument : ""));
    } else {
      policy.kappa =
          kappa_from_convention(convention.key, object[convention.key].get<double>(), formulation.d_hat);
    }
    used = convention.key;
  }
}

/// Settings that the policy does not read.
void check_policy_keys(const json& object, const std::string& name, const std::string& pointer,
                       const Reader& reader) {
  const bool silent = name == "fixed" || name == "ipc_adaptive";
  const auto refuse = [&](const char* key) {
    if (object.contains(key)) {
      reader.complain(pointer + "/" + key, object[key].dump(),
                      "nothing: the policy " + name + " does not read it");
    }
  };
  if (name != "elasticity_inclusive") {
    refuse("mass_term");
    refuse("elastic_term");
  }
  if (silent) refuse("refresh");
  if (name != "ipc_adaptive") {
    for (const char* key : {"kappa_min_N_per_m", "kappa_max_N_per_m", "doubling_gap_m"}) refuse(key);
  }
}

void read_policy(const json& object, const std::string& pointer, const Reader& reader,
                 const FormulationConfig& formulation, PolicyConfig& policy) {
  policy.name = object.value("name", policy.name);
  if (!find_entry(stiffness_policies(), policy.name)) {
    reader.take(unknown_name(reader.source + "#" + pointer + "/name", policy.name,
                             entry_names(stiffness_policies())));
    return;
  }
  check_policy_keys(object, policy.name, pointer, reader);
  read_kappa(object, pointer, reader, formulation, policy);
  policy.scale = object.value("scale", 1.0);
  policy.mass_term = require_mass_term(object.value("mass_term", "paper"));
  policy.elastic_term = object.value("elastic_term", true);
  policy.refresh = require_refresh(object.value("refresh", "per_iteration"));
  if (policy.name != "ipc_adaptive") return;
  policy.kappa_min = optional_number(object, "kappa_min_N_per_m");
  policy.kappa_max = optional_number(object, "kappa_max_N_per_m");
  policy.doubling_gap = optional_number(object, "doubling_gap_m");
}

/// The limit follows the contact's policy where it can.
PolicyConfig default_limit_policy(const FormulationConfig& formulation) {
  PolicyConfig policy;
  if (formulation.stiffness_policy.name != "elasticity_inclusive") return policy;
  policy.name = "elasticity_inclusive";
  policy.refresh = formulation.stiffness_policy.refresh;
  policy.elastic_term = formulation.stiffness_policy.elastic_term;
  policy.mass_term =
      formulation.stiffness_policy.mass_term == MassTerm::paper ? MassTerm::paper : MassTerm::inertia;
  return policy;
}

void read_limit_policy(const json& object, const Reader& reader, PolicyConfig& policy) {
  const std::string pointer = "/strain_limit/stiffness_policy";
  if (object.contains("name") && object["name"] != policy.name) policy = PolicyConfig();
  policy.name = object.value("name", policy.name);
  check_policy_keys(object, policy.name, pointer, reader);
  policy.k_s = optional_number(object, "k_s_N_per_m");
  if (policy.k_s && policy.name != "fixed") {
    reader.complain(pointer + "/k_s_N_per_m", object["k_s_N_per_m"].dump(),
                    "nothing: the policy is " + policy.name);
  }
  policy.scale = object.value("scale", 1.0);
  policy.mass_term = require_mass_term(object.value("mass_term", std::string(to_string(policy.mass_term))));
  policy.elastic_term = object.value("elastic_term", policy.elastic_term);
  policy.refresh = require_refresh(object.value("refresh", std::string(to_string(policy.refresh))));
}

/// True when a limit was found; onset and width are then set.
bool read_limit_width(const json& object, const Reader& reader, std::optional<double> fallback,
                      StrainLimitSpec& limit) {
  const bool onset = object.contains("onset"), width = object.contains("width");
  if (object.contains("limit") && (onset || width)) {
    reader.complain("/strain_limit/limit", object["limit"].dump(), "either limit, or onset and width");
  } else if (onset != width) {
    reader.missing(onset ? "/strain_limit/width" : "/strain_limit/onset", "onset and width together");
  }
  if (onset && width) {
    limit = {object["onset"].get<double>(), object["width"].get<double>()};
    return true;
  }
  const std::optional<double> bare = object.contains("limit") ? optional_number(object, "limit") : fallback;
  if (bare) limit = StrainLimitSpec::from_limit(*bare);
  return bare.has_value();
}

}  // namespace

void read_formulation(const json& object, const Reader& reader, double default_d_hat,
                      FormulationConfig& out) {
  out.name = object.value("name", "");
  if (object.contains("name")) {
    check_plain_name(reader.source + "#/formulation/name", out.name, reader.violations);
  }
  out.d_hat = object.value("d_hat_m", default_d_hat);
  out.shape = read_shape(object, "log", "/formulation", reader);
  out.argument = object.value("argument", "gap") == "gap" ? Argument::gap : Argument::squared_gap;
  read_policy(child(object, "stiffness_policy"), "/formulation/stiffness_policy", reader, out,
              out.stiffness_policy);
}

void read_strain_limit(const json& object, const Reader& reader, const FormulationConfig& formulation,
                       std::optional<double> default_limit, StrainLimitConfig& out) {
  out.shape = read_shape(object, formulation.shape, "/strain_limit", reader);
  out.argument = require_argument(object.value("argument", std::string(to_string(formulation.argument))));
  out.stiffness_policy = default_limit_policy(formulation);
  read_limit_policy(child(object, "stiffness_policy"), reader, out.stiffness_policy);
  const bool has_limit = read_limit_width(object, reader, default_limit, out.limit);
  out.enabled = object.value("enabled", has_limit);
  if (out.enabled && !has_limit) {
    reader.missing("/strain_limit/limit",
                   "a number > 0 and <= 10, or onset and width: this scene has no default");
  }
}

void read_matching(const json& object, const Reader& reader, bool literal, RunConfig& config) {
  const PolicyConfig& contact = config.formulation.stiffness_policy;
  const PolicyConfig& limit = config.strain_limit.stiffness_policy;
  const bool contact_given = contact.name != "fixed" || contact.kappa;
  const bool limit_given = !config.strain_limit.enabled || limit.name != "fixed" || limit.k_s;
  const bool as_given = literal || (contact_given && limit_given);
  const std::string rule = object.value("rule", as_given ? "as_given" : "equal_force");
  MatchingConfig& out = config.matching;
  out.rule = rule == "as_given"      ? MatchingRule::as_given
             : rule == "equal_force" ? MatchingRule::equal_force
                                     : MatchingRule::equal_curvature;
  out.theta = object.value("theta", out.theta);
  out.load = optional_number(object, "load_N");
  out.limit_load = optional_number(object, "limit_load_N_per_m");
  out.curvature = optional_number(object, "curvature_N_per_m");
  out.limit_curvature = optional_number(object, "limit_curvature_N_per_m");
  if (out.rule != MatchingRule::equal_curvature) {
    for (const char* key : {"curvature_N_per_m", "limit_curvature_N_per_m"}) {
      if (object.contains(key)) {
        reader.complain(std::string("/matching/") + key, object[key].dump(), "nothing: the rule is " + rule);
      }
    }
  }
  if (out.rule != MatchingRule::as_given) return;
  if (!contact_given) {
    reader.missing("/formulation/stiffness_policy/kappa_N_per_m",
                   "a number > 0 (N/m), or matching rule equal_force");
  }
  if (!limit_given) {
    reader.missing("/strain_limit/stiffness_policy/k_s_N_per_m",
                   "a number > 0 (N/m), or matching rule equal_force");
  }
}

}  // namespace bb
