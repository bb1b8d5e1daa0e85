// Settings with an earlier name, which configs may still have. Records and ids of runs keep the earlier name, so that they stay
// comparable and equal. The one table of them is in renamed_settings.cpp.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "core/math/error.hpp"

namespace bb {

/// Earlier names in the sections of a document become the present ones, with their values. A violation, at where/SECTION: a
/// section has a setting under both names.
std::optional<Violation> use_present_names(nlohmann::json& document, const std::string& where);

/// A pointer to a setting under its present name; its value becomes the present one.
std::string present_pointer(const std::string& pointer, nlohmann::json& value);

/// The other way round, for a section of a resolved document.
void use_recorded_names(const std::string& section, nlohmann::json& settings);

/// One line to the standard error for every setting that a config file or an override ("/pointer=value") gives under its earlier
/// name.
void note_earlier_names(const std::string& config_text, std::span<const std::string> overrides);

/// Adds the earlier names to the JSON Schema of a config, whose sections have their present ones.
void add_earlier_names(nlohmann::ordered_json& schema);

}  // namespace bb
