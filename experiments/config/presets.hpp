// Formulation presets, configs/formulations/NAME.json: {"name", "doc", "formulation": {...}}.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

struct PresetInfo {
  std::string name, doc;
};
/// Presets in the folder, by name.
std::vector<PresetInfo> formulation_presets();

/// Lays a formulation object over the preset that it names. An object that gives shape, argument and policy
/// itself needs no preset; its name is a label. Violations are appended at source#/formulation/name.
void expand_preset(nlohmann::json& formulation, const std::string& source,
                   std::vector<Violation>& violations);

}  // namespace bb
