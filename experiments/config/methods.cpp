#include "experiments/config/methods.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/base/input/json.hpp"
#include "core/base/parameters/registry.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/config/renamed_settings.hpp"
#include "experiments/config/sections.hpp"

namespace bb {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

Rule open_object(const char* doc) {
  Rule rule;
  rule.kind = Kind::object;
  rule.list = [doc](const json&) { return ParameterList{doc, {}, true, {}, ""}; };
  return required(rule);
}

ParameterList method_list() {
  return {"A published method.",
          {{"schema", required(word({"barrierbench.method/1"})), no_default, "Version of this format."},
           {"name", required(any_text()), no_default, "The name of the file."},
           {"doc", required(free_text()), no_default, "What it is."},
           {"source", required(text_up_to(0)), no_default, "Its publication."},
           {"set", open_object("JSON pointer into the config: value."), no_default, ""},
           {"because", open_object("Pointer of set: the fact that it follows."), no_default, ""},
           {"differs", open_object("Subject: what this program does otherwise."), no_default, ""}},
          false,
          {},
          ""};
}

Texts texts_of(const json& object, const std::string& where, std::vector<Violation>& violations) {
  Texts out;
  for (const auto& [key, value] : object.items()) {
    out[key] = value.is_string() ? value.get<std::string>() : "";
    const json::json_pointer place =
        json::json_pointer() / key;  // a pointer as a key: its slashes are escaped
    if (!value.is_string()) violations.push_back({where + place.to_string(), value.dump(), "a text"});
  }
  return out;
}

/// What a publication decides: not the scene, nor what is watched and written.
const std::set<std::string> sections = {"contact",       "formulation", "hessian",   "integrator",
                                        "linear_solver", "matching",    "precision", "step_solver",
                                        "strain_limit",  "time"};

const std::set<std::string> of_friction = {"friction"};
using Sections = std::set<std::string>;

bool is_of_a_method(const Sections& allowed, const std::string& pointer, const json& value) {
  const std::string section = pointer.substr(1, pointer.find('/', 1) - 1);
  return allowed.contains(section) && (pointer != "/formulation" || value.is_object());
}

/// The settings as a config of some scene, so that a pointer that no config has is refused where it stands.
void check_settings(const PublishedMethod& method, const Sections& allowed, const std::string& where,
                    std::vector<Violation>& violations) {
  json config = {{"schema", "barrierbench.config/1"}, {"scene", {{"name", "hang"}}}};
  for (const auto& [pointer, value] : method.set.items()) {
    if (!method.because.contains(pointer)) {
      violations.push_back({where + "/because", "nothing", "the fact that " + pointer + " follows"});
    }
    try {
      config[json::json_pointer(pointer)] = value;
    } catch (const json::exception&) {
      violations.push_back(
          {where + "/set", '"' + pointer + '"', "a JSON pointer into the config, such as /time/dt_s"});
      continue;
    }
    if (is_of_a_method(allowed, pointer, value)) continue;
    violations.push_back(
        {where + "/set", '"' + pointer + "\": " + value.dump(),
         fmt::format("a setting below one of {}; /formulation is an object", fmt::join(allowed, ", "))});
  }
  for (const auto& [pointer, fact] : method.because) {
    if (method.set.contains(pointer)) continue;
    violations.push_back({where + "/because", '"' + pointer + '"', "a pointer of set"});
  }
  check_value(config, settings_of<RunConfig>().rule(), where + "/set", violations);
}

std::string folder() { return configs_folder() + "/methods"; }
std::string friction_file(const std::string& method) { return folder() + "/friction/" + method + ".json"; }

/// Settings that the file has under an earlier name, under the present one: the files of registered runs stay as they are.
void use_present_pointers(PublishedMethod& method) {
  json set = json::object();
  Texts because;
  for (const auto& [pointer, value] : method.set.items()) {
    json now = value;
    const std::string present = present_pointer(pointer, now);
    set[present] = std::move(now);
  }
  for (const auto& [pointer, fact] : method.because) {
    json none;
    because[present_pointer(pointer, none)] = fact;
  }
  method.set = std::move(set);
  method.because = std::move(because);
}

/// A file of the form of a method whose settings lie below `allowed`.
PublishedMethod read_method(const std::string& path, const std::string& name, const Sections& allowed) {
  const std::string where = path + "#";
  json file = read_json_file(path, config_file);
  std::vector<Violation> violations;
  Rule rule;
  rule.kind = Kind::object;
  rule.list = [](const json&) { return method_list(); };
  check_value(file, rule, where, violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));

  PublishedMethod out{file["name"], file["doc"], file["source"], file["set"], {}, {}};
  if (out.name != name)
    violations.push_back({where + "/name", file["name"].dump(), '"' + name + "\", as its file"});
  out.because = texts_of(file["because"], where + "/because", violations);
  out.differs = texts_of(file["differs"], where + "/differs", violations);
  use_present_pointers(out);
  check_settings(out, allowed, where, violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  return out;
}

}  // namespace

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder(), error)) {
    if (file.path().extension() == ".json") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

PublishedMethod load_method(const std::string& name) {
  return read_method(folder() + "/" + name + ".json", name, sections);
}

PublishedMethod with_friction(PublishedMethod method) {
  const std::string path = friction_file(method.name);
  if (!fs::exists(path)) return method;
  const PublishedMethod more = read_method(path, method.name, of_friction);
  method.set.update(more.set);
  for (const auto& [pointer, fact] : more.because) method.because[pointer] = fact;
  for (const auto& [subject, text] : more.differs) method.differs[subject] = text;
  return method;
}

json friction_of_method(const std::string& name) {
  const PublishedMethod method = with_friction({name, "", "", json::object(), {}, {}});
  return method.set.empty() ? json::object() : method.set.unflatten().at("friction");
}

std::vector<PublishedMethod> published_methods() {
  std::vector<PublishedMethod> out;
  for (const std::string& name : method_names()) out.push_back(with_friction(load_method(name)));
  return out;
}

std::map<std::string, json> leaves_of(const PublishedMethod& method) {
  std::map<std::string, json> out;
  for (const auto& [pointer, value] : method.set.items()) {
    const json leaves = value.flatten();  // {"": value} of what is no object
    for (const auto& [inner, leaf] : leaves.items()) out[pointer + inner] = leaf;
  }
  return out;
}

std::vector<std::string> overridden(const PublishedMethod& method, const json& resolved) {
  std::vector<std::string> out;
  for (const auto& [pointer, value] : leaves_of(method)) {
    const json::json_pointer section(pointer.substr(0, pointer.find('/', 1)));
    const bool off = resolved.contains(section) && resolved[section].is_object() &&
                     resolved[section].value("enabled", json(true)) == false;
    const json::json_pointer place(pointer);
    if (!off && (!resolved.contains(place) || resolved[place] != value)) out.push_back(pointer);
  }
  return out;
}

MethodUse method_use(const RunConfig& config) {
  MethodUse use{load_method(config.method), {}};
  if (has_friction(config)) use.method = with_friction(std::move(use.method));
  use.overridden = overridden(use.method, settings_of<RunConfig>().write(config));
  return use;
}

}  // namespace bb
