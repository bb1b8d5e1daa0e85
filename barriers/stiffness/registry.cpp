// The list of stiffness policies, filled once from registry.inc.
#include "barriers/stiffness/registry.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "barriers/named_entries.hpp"

namespace bb {

#define ENTRY(name, doc) std::unique_ptr<StiffnessPolicy> make_policy_##name(const StiffnessPolicyConfig&);
#include "barriers/stiffness/registry.inc"
#undef ENTRY

namespace {

std::vector<StiffnessPolicyEntry>& mutable_policies() {
#define ENTRY(name, doc) {#name, doc, &make_policy_##name},
  static std::vector<StiffnessPolicyEntry> list{
#include "barriers/stiffness/registry.inc"
  };
#undef ENTRY
  return list;
}

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

const std::vector<StiffnessPolicyEntry>& stiffness_policies() { return mutable_policies(); }

void register_stiffness_policy(StiffnessPolicyEntry entry, std::string_view where) {
  append_entry(mutable_policies(), std::move(entry), where);
}

std::unique_ptr<StiffnessPolicy> make_policy(const StiffnessPolicyConfig& config) {
  if (!(config.multiplier > 0) || !std::isfinite(config.multiplier)) {
    throw ConfigError("stiffness_policy/multiplier", fmt::format("{}", config.multiplier), "a number > 0");
  }
  return require_entry(stiffness_policies(), config.name, "stiffness_policy/name").make(config);
}

std::string_view to_string(MassTerm mass_term) {
  switch (mass_term) {
    case MassTerm::paper:
      return "paper";
    case MassTerm::inertia:
      return "inertia";
    case MassTerm::none:
      break;
  }
  return "none";
}
std::string_view to_string(Refresh refresh) {
  return refresh == Refresh::per_iteration ? "per_iteration" : "per_step";
}
MassTerm require_mass_term(std::string_view name, std::string_view where) {
  return require_enum(std::array{MassTerm::paper, MassTerm::inertia, MassTerm::none}, name, where);
}
Refresh require_refresh(std::string_view name, std::string_view where) {
  return require_enum(std::array{Refresh::per_iteration, Refresh::per_step}, name, where);
}

}  // namespace bb
