// A config as a JSON document: text to value, `extends`, overrides, shorthands. Nothing is checked against
// the schema here. Outside this folder only `explain` reads it, to tell what a config gives from what it
// leaves to defaults.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// Errors: ConfigError at source:line for bad syntax or a key that stands twice in one object.
nlohmann::json parse_json(const std::string& text, const std::string& source);

/// Errors: ConfigError for an unreadable file.
std::string read_text_file(const std::string& path);

/// Text to a document: mesh paths made absolute from `folder`, "extends" laid underneath (and its own, in
/// turn), then the overrides "/pointer=value". Violations of overrides are appended. Errors: ConfigError as
/// parse_json, unreadable or circular `extends`.
nlohmann::json make_document(const std::string& text, const std::string& source, const std::string& folder,
                             std::span<const std::string> overrides, std::vector<Violation>& violations);

}  // namespace bb
