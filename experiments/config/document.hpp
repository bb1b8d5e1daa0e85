// A config as a JSON document: text to value, `extends`, overrides, shorthands. Nothing is checked against
// the schema here. Outside this folder only `explain` reads it, to separate what a config gives from what it
// leaves to defaults.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// Errors: ConfigError, alone and with the verb to use, when the document states that it is of another format of ours than
/// `format`, such as "barrierbench.config/1": every key of a sweep is wrong in a config.
void require_format(const nlohmann::json& document, std::string_view format, const std::string& source);

/// Text to a document: mesh paths made absolute from `folder`, "extends" laid underneath (and its own, in
/// turn), then the overrides "/pointer=value": an override
/// makes missing keys of objects, but never elements of an array. Violations of overrides are appended.
/// The settings of a method are laid over what its file extends and under what the file itself says; those of a method that
/// an override names over the file and under all overrides. Only the highest method counts.
/// Errors: ConfigError as parse_json and require_format, unreadable, circular or too long `extends`.
nlohmann::json make_document(const std::string& text, const std::string& source, const std::string& folder,
                             std::span<const std::string> overrides, std::vector<Violation>& violations);

/// One of these overrides. It reads and changes nothing but the section that its pointer begins with, so that a document with
/// that section alone does as well.
void apply_override(nlohmann::json& document, const std::string& text, const std::string& folder,
                    std::vector<Violation>& violations);

}  // namespace bb
