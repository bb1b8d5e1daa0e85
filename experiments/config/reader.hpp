// Reading of a config document whose types the schema has already settled. Private to experiments/config.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/math/error.hpp"
#include "core/math/types.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {

/// Where violations go.
struct Reader {
  const std::string& source;
  std::vector<Violation>& violations;
  bool complete = true;  // false when wrong values were removed: what is missing may have been given

  void complain(const std::string& pointer, std::string found, std::string allowed) const {
    violations.push_back({source + "#" + pointer, std::move(found), std::move(allowed)});
  }
  void missing(const std::string& pointer, std::string allowed) const {
    if (complete) complain(pointer, "nothing", std::move(allowed));
  }
  /// Moves a ConfigError of a registry here.
  void take(const ConfigError& error) const {
    violations.insert(violations.end(), error.violations().begin(), error.violations().end());
  }
};

/// The object under a key; an empty one when absent.
inline const nlohmann::json& child(const nlohmann::json& object, const char* key) {
  static const nlohmann::json none = nlohmann::json::object();
  return object.contains(key) ? object[key] : none;
}
inline std::optional<double> optional_number(const nlohmann::json& object, const char* key) {
  return object.contains(key) ? std::optional<double>(object[key].get<double>()) : std::nullopt;
}
inline Vec3d to_vector(const nlohmann::json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}
inline Vec3d vector_or(const nlohmann::json& object, const char* key, const Vec3d& fallback) {
  return object.contains(key) ? to_vector(object[key]) : fallback;
}

/// The scene section; null when it names no registered scene.
const ProceduralScene* read_scene(const nlohmann::json& object, const Reader& reader, SceneConfig& scene);

/// Everything else, with the scene's defaults. `scene` may be null.
void read_formulation(const nlohmann::json& object, const Reader& reader, double default_d_hat,
                      FormulationConfig& formulation);
void read_strain_limit(const nlohmann::json& object, const Reader& reader,
                       const FormulationConfig& formulation, std::optional<double> default_limit,
                       StrainLimitConfig& limit);
void read_matching(const nlohmann::json& object, const Reader& reader, bool literal, RunConfig& config);
void read_pipeline(const nlohmann::json& document, const Reader& reader, const SceneDefaults& defaults,
                   bool literal, RunConfig& config);

/// Contradictions between sections (check_config.cpp); no JSON.
void check_contradictions(const RunConfig& config, const std::string& source,
                          std::vector<Violation>& violations);

}  // namespace bb
