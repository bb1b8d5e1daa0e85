// JSON in, RunConfig out, and back. Every violation of a file is reported at once, each with
// file#/json/pointer, the value found and the values allowed.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/scene/scene.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// Reads a config file; -: the standard input, whose relative paths start where the program was started. "extends": PATH (relative to the file) is laid underneath, object by object; then
/// each override "/pointer=value" (value: JSON, or a bare word taken as a string) is set, in order. A
/// formulation or a scene whose name changes on the way starts anew, but the formulation keeps its d_hat_m. A method lies
/// underneath what stands beside its name (document.hpp).
/// Errors: ConfigError: unreadable file, JSON syntax (file:line), schema, unknown name (nearest suggested),
///   contradiction, bad override.   Cost: milliseconds; mesh files are hashed.
RunConfig load_config(const std::string& path, std::span<const std::string> overrides = {});

/// The same from text; `source` is used in messages, relative paths start at `folder`.
RunConfig parse_config(const std::string& text, const std::string& source, const std::string& folder = ".",
                       std::span<const std::string> overrides = {});

/// Canonical JSON of a config: every default filled in, presets expanded, keys sorted, doubles that read back
/// bit for bit, two-space indent. parse_config(resolved_json(c)) gives the same text.
std::string resolved_json(const RunConfig& config);
/// The document that it is the text of.
nlohmann::json resolved_document(const RunConfig& config);

/// The same with the present names of settings whose earlier names records keep (renamed_settings.hpp).
nlohmann::json settings_document(const RunConfig& config);

/// Identity of a run: config_id of core/base/record applied to it.
std::string config_id(const RunConfig& config);

/// The scene of a config: procedural, or from its bodies. Jitter applied. Deterministic.
/// Errors: ConfigError (mesh files, scene checks).
Scene build_scene(const RunConfig& config);

/// Body i of a config with its mesh and rest shape placed, its films and weights read, and in the indices of its pins the
/// vertices of objects that they name. Without d_hat and limit. Errors: as build_scene.
BodySpec placed_body(const RunConfig& config, std::size_t i);

/// The folder of presets, schema and scenes: $BARRIERBENCH_CONFIGS, else the one this program
/// was built beside.
std::string configs_folder();

}  // namespace bb
