#include "experiments/config/document.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace bb {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::string place(const std::string& text, const std::string& source, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return source + ":" + std::to_string(1 + std::count(text.begin(), end, '\n'));
}

/// "formulation": "NAME" means {"name": "NAME"}.
void expand_shorthands(json& document) {
  if (!document.is_object() || !document.contains("formulation")) return;
  json& formulation = document["formulation"];
  if (formulation.is_string()) formulation = json{{"name", formulation}};
}

void absolute_mesh_paths(json& document, const std::string& folder) {
  const json::json_pointer bodies("/scene/bodies");
  if (!document.is_object() || !document.contains(bodies) || !document[bodies].is_array()) return;
  for (json& body : document[bodies]) {
    if (!body.is_object() || !body.contains("mesh") || !body["mesh"].is_object()) continue;
    json& mesh = body["mesh"];
    if (!mesh.contains("file") || !mesh["file"].is_string() || mesh["file"].get<std::string>().empty())
      continue;
    mesh["file"] =
        fs::absolute(fs::path(folder) / mesh["file"].get<std::string>()).lexically_normal().string();
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

json with_base(json document, const std::string& source, const std::string& folder,
               std::vector<std::string> chain) {
  expand_shorthands(document);
  absolute_mesh_paths(document, folder);
  if (!document.is_object() || !document.contains("extends") || !document["extends"].is_string())
    return document;
  const std::string path =
      fs::absolute(fs::path(folder) / document["extends"].get<std::string>()).lexically_normal();
  if (std::find(chain.begin(), chain.end(), path) != chain.end()) {
    throw ConfigError(source + "#/extends", '"' + path + '"', "a config that does not lead back to this one");
  }
  chain.push_back(path);
  std::string text;
  try {
    text = read_text_file(path);
  } catch (const ConfigError& error) {
    throw ConfigError(source + "#/extends", '"' + path + '"', error.violations().front().allowed);
  }
  json base = with_base(parse_json(text, path), path, fs::path(path).parent_path(), std::move(chain));
  document.erase("extends");
  drop_replaced(base, document);
  lay_over(base, document);
  return base;
}

void apply_override(json& document, const std::string& text, const std::string& folder,
                    std::vector<Violation>& violations) {
  const std::size_t equals = text.find('=');
  if (text.empty() || text[0] != '/' || equals == std::string::npos) {
    violations.push_back({"--set " + text, '"' + text + '"', "/pointer=value, for example /time/dt_s=0.005"});
    return;
  }
  const std::string right = text.substr(equals + 1);
  json value = json::parse(right, nullptr, false);
  if (value.is_discarded()) value = right;  // a bare word
  try {
    const json::json_pointer pointer(text.substr(0, equals));
    const std::string name = pointer.to_string();
    if (name == "/formulation" || name == "/formulation/name" || name == "/scene/name") {
      json over = json::object();
      over[pointer] = value;
      expand_shorthands(over);
      drop_replaced(document, over);
      lay_over(document, over);
    } else if (document.contains(pointer.parent_pointer()) && document[pointer.parent_pointer()].is_array()) {
      document.at(pointer) = value;  // throws when there is no such element
    } else {
      document[pointer] = value;
    }
  } catch (const json::exception&) {
    violations.push_back(
        {"--set " + text, '"' + text.substr(0, equals) + '"', "a pointer to a place of this config"});
  }
  absolute_mesh_paths(document, folder);
}

}  // namespace

std::string read_text_file(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw ConfigError(path, "no such file", "a readable file");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw ConfigError(path, std::string("unreadable: ") + std::strerror(errno), "a readable file");
  return text.str();
}

json parse_json(const std::string& text, const std::string& source) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  std::string repeated;
  const auto watch = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) {
      repeated = value.get<std::string>();
    }
    return true;
  };
  try {
    json document = json::parse(text, watch);
    if (!repeated.empty())
      throw ConfigError(source, "the key \"" + repeated + "\" twice in one object", "each key once");
    return document;
  } catch (const json::parse_error& error) {
    std::string what = error.what();
    const std::size_t colon = what.find(": ");
    throw ConfigError(place(text, source, error.byte > 0 ? error.byte - 1 : 0),
                      colon == std::string::npos ? what : what.substr(colon + 2), "JSON");
  } catch (const json::out_of_range& error) {
    throw ConfigError(source, error.what(), "numbers within the range of double");
  }
}

json make_document(const std::string& text, const std::string& source, const std::string& folder,
                   std::span<const std::string> overrides, std::vector<Violation>& violations) {
  json document = with_base(parse_json(text, source), source, folder, {});
  for (const std::string& text_of_override : overrides) {
    apply_override(document, text_of_override, folder, violations);
  }
  return document;
}

}  // namespace bb
