// The lists of settings that a config is made of. Private to experiments/config, but for config_list, which
// help and the schema print.
#pragma once

#include "core/base/parameters/settings.hpp"
#include "core/model/bodies/material_settings.hpp"
#include "experiments/config/enum_words.hpp"

namespace bb {

#define SECTION(type, doc) \
  template <>              \
  Settings<type> list_of();
#define SETTING(...)
#define NEST(...)
#define OWN(...)
#define END_SECTION
#include "experiments/config/settings.inc"
#define SECTION(type, doc) \
  template <>              \
  Settings<type> list_of();
#define ROW(...)
#define NEST(...)
#define ALL(...)
#define EXTRA(...)
#define END_SECTION
#include "experiments/config/scene.inc"
template <>
Settings<RunConfig> list_of();

/// A policy of the contacts, or of the strain limit: its name, a scale, and the parameters of every policy.
const Settings<PolicyConfig>& contact_policy_settings();
const Settings<PolicyConfig>& limit_policy_settings();

/// What rules a scene section: bodies, or a registered scene with its own parameters.
Rule scene_rule();
/// What rules a mesh: a generator with its own parameters, or a file.
Rule mesh_rule();
/// The scene section of a resolved config.
nlohmann::json scene_json(const SceneConfig& scene);
/// Settings that bodies or obstacles of other kinds have, and one of this kind has not.
std::vector<std::string> keys_of_others(BodyKind kind);
std::vector<std::string> keys_of_others(ObstacleKind kind);

}  // namespace bb
