// The list of stiffness policies, filled once from registry.inc.
#include "barriers/stiffness/registry.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace bb {

#define ENTRY(name, doc) StiffnessPolicyEntry policy_##name();
#include "barriers/stiffness/registry.inc"
#undef ENTRY

namespace {

/// The enumerator whose to_string is `name`.
template <class Enum, std::size_t n>
Enum require_enum(const std::array<Enum, n>& all, std::string_view name, std::string_view where) {
  std::vector<std::string> names;
  for (const Enum value : all) {
    if (to_string(value) == name) return value;
    names.emplace_back(to_string(value));
  }
  throw unknown_name(where, name, names);
}

}  // namespace

Registry<StiffnessPolicyEntry>& stiffness_policies() {
#define ENTRY(name, doc) named(policy_##name(), #name, doc),
  static Registry<StiffnessPolicyEntry> all({
#include "barriers/stiffness/registry.inc"
  });
#undef ENTRY
  return all;
}

std::unique_ptr<StiffnessPolicy> make_policy(const StiffnessPolicyConfig& config) {
  if (!(config.multiplier > 0) || !std::isfinite(config.multiplier)) {
    throw ConfigError("stiffness_policy/multiplier", fmt::format("{}", config.multiplier), "a number > 0");
  }
  const StiffnessPolicyEntry& entry = stiffness_policies().require(config.name, "stiffness_policy/name");
  StiffnessPolicyConfig complete = config;
  complete.parameters = own_parameters(entry.parameters, config.parameters, "stiffness_policy");
  return entry.make(complete);
}

Parameter refresh_parameter() {
  return {"refresh", word({"per_iteration", "per_step"}), "per_iteration", "when kappa is computed anew"};
}

Parameter gap_floor_parameter() {
  return {"gap_floor", number_in(0, 1, "d_hat"), 0.0,
          "smallest gap at which kappa is asked, in units of d_hat, or of the width of a strain limit"};
}

Parameter derivative_parameter() {
  return {"derivative", word({"dropped", "included"}), "dropped",
          "kappa'(d) left out of the curvature, or the force derived from its potential"};
}

void check_derivative(const ParameterMap& parameters, const std::string& where) {
  if (require_derivative(text(parameters, "derivative")) == KappaDerivative::dropped) return;
  const std::string &mass_term = text(parameters, "mass_term"), &refresh = text(parameters, "refresh");
  std::vector<Violation> violations;
  if (!depends_on_gap(require_mass_term(mass_term))) {
    violations.push_back({where + "/derivative", fmt::format("\"included\" with mass_term {}", mass_term),
                          "dropped, or mass_term paper or scaled: this kappa does not depend on the gap"});
  }
  if (require_refresh(refresh) != Refresh::per_step) {
    violations.push_back({where + "/refresh", fmt::format("\"{}\"", refresh),
                          "per_step, or derivative dropped: a potential is frozen for a step"});
  }
  if (number(parameters, "gap_floor") > 0) {
    violations.push_back({where + "/gap_floor", fmt::format("{}", number(parameters, "gap_floor")),
                          "0, or derivative dropped: a potential has no floor"});
  }
  if (!violations.empty()) throw ConfigError(violations);
}

std::string_view to_string(MassTerm mass_term) {
  switch (mass_term) {
    case MassTerm::paper:
      return "paper";
    case MassTerm::inertia:
      return "inertia";
    case MassTerm::scaled:
      return "scaled";
    case MassTerm::none:
      break;
  }
  return "none";
}
std::string_view to_string(Refresh refresh) {
  return refresh == Refresh::per_iteration ? "per_iteration" : "per_step";
}
std::string_view to_string(KappaDerivative derivative) {
  return derivative == KappaDerivative::dropped ? "dropped" : "included";
}
MassTerm require_mass_term(std::string_view name, std::string_view where) {
  return require_enum(std::array{MassTerm::paper, MassTerm::inertia, MassTerm::scaled, MassTerm::none}, name,
                      where);
}
Refresh require_refresh(std::string_view name, std::string_view where) {
  return require_enum(std::array{Refresh::per_iteration, Refresh::per_step}, name, where);
}
KappaDerivative require_derivative(std::string_view name, std::string_view where) {
  return require_enum(std::array{KappaDerivative::dropped, KappaDerivative::included}, name, where);
}

}  // namespace bb
