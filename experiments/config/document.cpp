#include "experiments/config/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/input/json.hpp"
#include "core/base/input/names.hpp"
#include "core/base/record/schema_version.hpp"
#include "experiments/config/methods.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/renamed_settings.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// "formulation": "NAME" means {"name": "NAME"}.
void expand_shorthands(json& document) {
  if (!document.is_object() || !document.contains("formulation")) return;
  json& formulation = document["formulation"];
  if (formulation.is_string()) formulation = json{{"name", formulation}};
}

/// Of an object that names a file.
void absolute_path(json& mesh, const std::string& folder) {
  if (!mesh.is_object() || !mesh.contains("file") || !mesh["file"].is_string() ||
      mesh["file"].get<std::string>().empty())
    return;
  const std::string path =
      fs::absolute(fs::path(folder) / mesh["file"].get<std::string>()).lexically_normal().string();
  if (!is_utf8(path)) throw ConfigError(path, "a path that is not UTF-8", "UTF-8: records name their meshes");
  mesh["file"] = path;
}

void absolute_mesh_path(json& body, const char* key, const std::string& folder) {
  if (body.is_object() && body.contains(key)) absolute_path(body[key], folder);
}

void absolute_film_path(json& motion, const std::string& folder) {
  if (motion.is_object()) absolute_mesh_path(motion, "film", folder);
}

void absolute_mesh_paths(json& document, const std::string& folder) {
  const json::json_pointer bodies("/scene/bodies");
  if (!document.is_object() || !document.contains(bodies) || !document[bodies].is_array()) return;
  for (json& body : document[bodies]) {
    for (const char* key : {"mesh", "rest_mesh", "rest_film"}) absolute_mesh_path(body, key, folder);
    if (!body.is_object()) continue;
    if (body.contains("motion")) absolute_film_path(body["motion"], folder);
    if (body.contains("weights") && body["weights"].is_array()) {
      for (json& group : body["weights"]) absolute_path(group, folder);
    }
    if (!body.contains("pins") || !body["pins"].is_array()) continue;
    for (json& pin : body["pins"]) {
      if (pin.is_object() && pin.contains("motion")) absolute_film_path(pin["motion"], folder);
    }
  }
}

/// A formulation or a scene named anew starts anew; a formulation keeps its length scale d_hat.
void drop_replaced(json& base, const json& over) {
  for (const char* key : {"formulation", "scene"}) {
    if (!base.contains(key) || !over.contains(key) || !base[key].is_object() || !over[key].is_object())
      continue;
    if (!over[key].contains("name") || base[key].value("name", json()) == over[key]["name"]) continue;
    json kept = json::object();
    if (std::strcmp(key, "formulation") == 0 && base[key].contains("d_hat_m"))
      kept["d_hat_m"] = base[key]["d_hat_m"];
    base[key] = kept;
  }
}

/// A policy of another name starts anew too: parameters of one mean nothing to another.
void drop_other_policy(json& base, const json& over) {
  for (const char* section : {"/formulation", "/strain_limit"}) {
    const json::json_pointer place = json::json_pointer(section) / "stiffness_policy";
    if (!base.contains(place) || !over.contains(place)) continue;
    json& below = base[place];
    const json& above = over[place];
    if (!below.is_object() || !above.is_object() || !below.contains("name") || !above.contains("name"))
      continue;
    if (below["name"] != above["name"]) below = json::object();
  }
}

/// steps and duration_s replace each other, and steps that went with a duration end with another dt.
void drop_other_length(json& base, const json& over) {
  const json::json_pointer time("/time");
  if (!base.contains(time) || !over.contains(time) || !base[time].is_object() || !over[time].is_object())
    return;
  json& below = base[time];
  const json& above = over[time];
  const bool steps = above.contains("steps"), duration = above.contains("duration_s");
  if (steps && !duration) {
    below.erase("duration_s");
  } else if (duration || (above.contains("dt_s") && below.contains("duration_s"))) {
    below.erase("steps");
  }
}

void lay_over(json& base, const json& over) {
  if (!base.is_object() || !over.is_object()) {
    base = over;
    return;
  }
  for (const auto& [key, value] : over.items()) {
    if (base.contains(key)) {
      lay_over(base[key], value);
    } else {
      base[key] = value;
    }
  }
}

/// False when there is no such place.
bool set_value(json& document, const json::json_pointer& pointer, json value);

/// Steps of the document become the time that they take, where a method with another dt is laid over them. Without a dt of
/// its own the document has that of its scene.
void keep_duration(json& document) {
  const json::json_pointer time("/time"), name("/scene/name");
  if (!document.contains(time) || !document[time].is_object() || document[time].contains("duration_s"))
    return;
  json& length = document[time];
  if (!length.contains("steps") || !length["steps"].is_number_integer()) return;
  const ProceduralScene* scene = document.contains(name) && document[name].is_string()
                                     ? procedural_scenes().find(document[name].get<std::string>())
                                     : nullptr;
  const json dt = length.contains("dt_s") ? length["dt_s"] : scene ? json(scene->defaults.dt) : json();
  if (!dt.is_number()) return;  // reported when the config is checked
  length["duration_s"] = dt.get<double>() * length["steps"].get<double>();
  length.erase("steps");
}

/// The settings of a method, over what the document has. A name that no method has is reported when the config is checked.
void lay_method(json& document, const json& name) {
  const std::vector<std::string> names = method_names();
  if (!document.is_object() || !name.is_string() ||
      std::find(names.begin(), names.end(), name) == names.end())
    return;
  const PublishedMethod method = load_method(name);
  if (method.set.contains("/time/dt_s")) keep_duration(document);
  for (const auto& [pointer, value] : method.set.items()) {
    set_value(document, json::json_pointer(pointer), value);
  }
  if (!document.contains("friction") || !document["friction"].is_object()) return;
  const json over =
      friction_of_method(method.name);  // laid where a coefficient is known to be above 0 (settle_friction)
  for (const auto& item : over.items()) document["friction"].erase(item.key());
}

constexpr std::size_t max_chain = 16;  // configs that extend one another

json with_base(json document, const std::string& source, const std::string& folder,
               std::vector<std::string> chain, bool method_above);

/// What the document extends; an empty object where it extends nothing.
json base_of(const json& document, const std::string& source, const std::string& folder,
             std::vector<std::string> chain, bool method_above) {
  if (!document.contains("extends") || !document["extends"].is_string()) return json::object();
  const std::string path =
      fs::absolute(fs::path(folder) / document["extends"].get<std::string>()).lexically_normal();
  if (std::find(chain.begin(), chain.end(), path) != chain.end()) {
    throw ConfigError(source + "#/extends", '"' + path + '"', "a config that does not lead back to this one");
  }
  if (chain.size() >= max_chain) {
    throw ConfigError(source + "#/extends", '"' + path + '"',
                      fmt::format("a chain of at most {} configs", max_chain));
  }
  chain.push_back(path);
  std::string text;
  try {
    text = read_input_file(path, config_file);
  } catch (const ConfigError& error) {
    const Violation& wrong = error.violations().front();
    throw ConfigError(source + "#/extends", '"' + path + "\": " + wrong.found, wrong.allowed);
  }
  return with_base(parse_json(text, path), path, fs::path(path).parent_path(), std::move(chain),
                   method_above);
}

/// From below: what is extended, the method, the document itself. Only the highest method counts: method_above says that
/// there is a higher one.
json with_base(json document, const std::string& source, const std::string& folder,
               std::vector<std::string> chain, bool method_above) {
  expand_shorthands(document);
  absolute_mesh_paths(document, folder);
  if (!document.is_object()) return document;
  require_format(document, "barrierbench.config/1", source);
  if (std::optional<Violation> twice = use_present_names(document, source + "#"))
    throw ConfigError(std::vector<Violation>{*twice});
  if (method_above) document.erase("method");
  const bool has_method = document.contains("method");
  json base = base_of(document, source, folder, std::move(chain), method_above || has_method);
  if (document.contains("extends") && document["extends"].is_string()) document.erase("extends");
  if (has_method) lay_method(base, document["method"]);
  drop_replaced(base, document);
  drop_other_policy(base, document);
  drop_other_length(base, document);
  lay_over(base, document);
  return base;
}

/// The value of an override: JSON, or a bare word. Text that starts like an array, an object or a string has
/// to be one. Errors: JsonError.
json override_value(const std::string& text, const std::string& source) {
  if (!is_utf8(text)) throw JsonError(JsonFault::syntax, source, "bytes that are not UTF-8", "UTF-8");
  try {
    return parse_json(text, source);
  } catch (const JsonError& error) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool structured = first != std::string::npos && std::strchr("[{\"", text[first]) != nullptr;
    if (structured || error.fault() != JsonFault::syntax) throw;
    return text;
  }
}

std::vector<std::string> tokens_of(json::json_pointer pointer) {
  std::vector<std::string> tokens;
  for (; !pointer.empty(); pointer.pop_back()) tokens.insert(tokens.begin(), pointer.back());
  return tokens;
}

/// The element of an array that a token names; null when there is none.
json* element(json& array, const std::string& token) {
  std::size_t index = 0;
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, index);
  return error == std::errc() && stop == end && index < array.size() ? &array[index] : nullptr;
}

/// The place that a pointer names. Keys of objects are made where they are missing, elements of arrays never:
/// an array has the elements that its file gave it. Null when there is no such place.
json* place_of(json& document, const std::vector<std::string>& tokens) {
  json* at = &document;
  for (const std::string& token : tokens) {
    if (at->is_null()) *at = json::object();
    if (!at->is_object() && !at->is_array()) return nullptr;
    at = at->is_array() ? element(*at, token) : &(*at)[token];
    if (at == nullptr) return nullptr;
  }
  return at;
}

bool set_value(json& document, const json::json_pointer& pointer, json value) {
  const std::string name = pointer.to_string();
  const bool replaces = name == "/formulation" || name == "/formulation/name" || name == "/scene/name" ||
                        name.ends_with("/stiffness_policy/name");
  if (!replaces) {
    if (name.starts_with("/time/")) drop_other_length(document, {{"time", {{pointer.back(), value}}}});
    json* place = place_of(document, tokens_of(pointer));
    if (place != nullptr) *place = std::move(value);
    return place != nullptr;
  }
  json over = json::object();
  over[pointer] = std::move(value);
  expand_shorthands(over);
  drop_replaced(document, over);
  drop_other_policy(document, over);
  lay_over(document, over);
  return true;
}

/// The method that overrides name; nothing where they name none, or where the value cannot be read, which apply_override
/// reports.
std::optional<json> named_method(std::span<const std::string> overrides) {
  const std::string key = "/method=";
  std::optional<json> out;
  for (const std::string& text : overrides) {
    if (!text.starts_with(key)) continue;
    try {
      out = override_value(text.substr(key.size()), text);
    } catch (const JsonError&) {
    }
  }
  return out;
}

}  // namespace

void apply_override(json& document, const std::string& text, const std::string& folder,
                    std::vector<Violation>& violations) {
  const std::size_t equals = text.find('=');
  const std::string where = "--set " + shortened(text);
  if (text.empty() || text[0] != '/' || equals == std::string::npos) {
    violations.push_back(
        {where, '"' + shortened(text) + '"', "/pointer=value, for example /time/dt_s=0.005"});
    return;
  }
  if (text.starts_with("/extends=")) {  // what a config is laid over is read before its settings
    violations.push_back({where, "/extends", "a setting: what a config extends stands in its file"});
    return;
  }
  bool placed = false;
  try {
    json value = override_value(text.substr(equals + 1), where);
    const std::string pointer = present_pointer(text.substr(0, equals), value);
    placed = set_value(document, json::json_pointer(pointer), std::move(value));
    if (const std::optional<Violation> twice = use_present_names(document, where))
      violations.push_back(*twice);
  } catch (const JsonError& error) {
    violations.push_back({where, error.violations().front().found, error.violations().front().allowed});
    return;
  } catch (const json::exception&) {  // no pointer
  }
  if (!placed) {
    violations.push_back(
        {where, '"' + shortened(text.substr(0, equals)) + '"',
         "a pointer to a place of this config: keys are made where they are missing, elements "
         "of arrays are not"});
  }
  absolute_mesh_paths(document, folder);
}

void require_format(const json& document, std::string_view format, const std::string& source) {
  const json& schema = child(document, "schema");
  const json& word =
      schema.is_object() ? child(schema, "name") : schema;  // a record has a name and a version
  if (!word.is_string()) return;
  const std::string name = word.get<std::string>();
  if (!name.starts_with("barrierbench.") || name == format) return;
  std::string allowed = fmt::format("\"{}\"", format);
  if (name == run_schema_name)
    allowed += ": this is the record of a run, ./bench run FILE repeats it; its `config` is one";
  if (name == "barrierbench.sweep/1")
    allowed += ": this is a sweep, ./bench sweep FILE --dry-run lists its runs";
  if (name == "barrierbench.config/1") allowed += ": this is the config of one run, ./bench run FILE";
  throw ConfigError(source + "#/schema", fmt::format("\"{}\"", name), std::move(allowed));
}

json make_document(const std::string& text, const std::string& source, const std::string& folder,
                   std::span<const std::string> overrides, std::vector<Violation>& violations) {
  const std::optional<json> method = named_method(overrides);
  json document = with_base(parse_json(text, source), source, folder, {}, method.has_value());
  if (method) lay_method(document, *method);
  for (const std::string& text_of_override : overrides) {
    apply_override(document, text_of_override, folder, violations);
  }
  return document;
}

}  // namespace bb
