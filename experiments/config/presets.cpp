#include "experiments/config/presets.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/input/json.hpp"
#include "core/base/parameters/registry.hpp"
#include "experiments/config/formula_shapes.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/config/sections.hpp"

namespace bb {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json read_preset(const std::string& path) {
  json preset = read_json_file(path, config_file);
  if (!preset.is_object() || !preset.contains("formulation") || !preset["formulation"].is_object()) {
    throw ConfigError(path, "no formulation", "an object with name, doc and formulation");
  }
  if (!preset.value("doc", json("")).is_string())
    throw ConfigError(path + "#/doc", preset["doc"].dump(), "a string");
  std::vector<Violation> violations;
  check_value(preset["formulation"], settings_of<FormulationConfig>().rule(), path + "#/formulation",
              violations);
  name_formula(preset["formulation"], path + "#/formulation", violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  return preset;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder, error)) {
    if (file.path().extension() == ".json") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// What was read of a file or a folder, read again only when that has changed: a sweep resolves its presets for every case.
template <class T>
class ReadOnce {
 public:
  template <class Read>
  T get(const std::string& path, const Read& read) {
    std::error_code error;
    const fs::file_time_type changed = fs::last_write_time(path, error);
    {
      const std::lock_guard lock(mutex_);
      const auto found = kept_.find(path);
      if (!error && found != kept_.end() && found->second.first == changed) return found->second.second;
    }
    T value = read(path);
    const std::lock_guard lock(mutex_);
    kept_[path] = {changed, value};
    return value;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::pair<fs::file_time_type, T>> kept_;
};

std::string presets_folder() { return configs_folder() + "/formulations"; }

json load_preset(const std::string& name) {
  static ReadOnce<json> presets;
  return presets.get(presets_folder() + "/" + name + ".json", read_preset);
}

std::vector<std::string> preset_names() {
  static ReadOnce<std::vector<std::string>> names;
  return names.get(presets_folder(), names_in);
}

/// A policy of another name replaces the preset's; a new kappa replaces the old one whatever its convention.
/// The bounds of an adaptive kappa (kappa_min, kappa_max) are no conventions and are kept as given.
void lay_over_policy(json& base, const json& over) {
  if (over.contains("name") && over["name"] != base.value("name", json())) base = json::object();
  const auto is_kappa = [](const std::string& key) {
    return key.starts_with("kappa_") && !key.starts_with("kappa_min_") && !key.starts_with("kappa_max_");
  };
  for (const auto& item : over.items()) {
    if (!is_kappa(item.key())) continue;
    for (auto it = base.begin(); it != base.end();) it = is_kappa(it.key()) ? base.erase(it) : std::next(it);
    break;
  }
  base.update(over);
}

/// A record must not carry the name of a preset whose shape, argument or policy it replaced.
bool is_another(const json& formulation, const json& preset) {
  const auto policy = [](const json& j) {
    return j.value("stiffness_policy", json::object()).value("name", json());
  };
  for (const char* key : {"shape", "argument"}) {
    if (formulation.value(key, json()) != preset.value(key, json())) return true;
  }
  return policy(formulation) != policy(preset);
}

/// What a formulation of the user's own making, with a name of its own, lacks, in words; nothing where it has none of the keys.
std::string missing_of(const json& formulation) {
  std::string lacks;
  bool has = false;
  for (const char* key : {"shape", "argument", "stiffness_policy"}) {
    if (formulation.contains(key)) {
      has = true;
    } else {
      lacks += (lacks.empty() ? "" : ", ") + std::string(key);
    }
  }
  return has ? "; or any name beside shape, argument and stiffness_policy (missing: " + lacks + ")" : "";
}

}  // namespace

std::string configs_folder() {
  const char* folder = std::getenv("BARRIERBENCH_CONFIGS");
  return folder && *folder ? folder : BB_CONFIGS_DIR;
}

std::vector<PresetInfo> formulation_presets() {
  std::vector<PresetInfo> out;
  for (const std::string& name : preset_names()) out.push_back({name, load_preset(name).value("doc", "")});
  return out;
}

void expand_preset(json& formulation, const std::string& source, std::vector<Violation>& violations) {
  if (!formulation.contains("name")) return;
  const bool whole = formulation.contains("shape") && formulation.contains("argument") &&
                     formulation.contains("stiffness_policy");
  const std::string name = formulation["name"].get<std::string>();
  const std::vector<std::string> names = preset_names();
  if (whole) {  // of the user's own making, or a resolved preset
    const bool known = std::find(names.begin(), names.end(), name) != names.end();
    if (known && is_another(formulation, load_preset(name)["formulation"])) formulation.erase("name");
    return;
  }
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    violations.push_back(unknown_name(source + "#/formulation/name", name, names).violations().front());
    violations.back().allowed += missing_of(formulation);
    return;
  }
  json base = load_preset(name)["formulation"];
  const json preset = base;
  json policy = base.value("stiffness_policy", json::object());
  if (formulation.contains("stiffness_policy")) lay_over_policy(policy, formulation["stiffness_policy"]);
  base.update(formulation);
  base["stiffness_policy"] = policy;
  if (is_another(base, preset)) base.erase("name");
  formulation = base;
}

}  // namespace bb
