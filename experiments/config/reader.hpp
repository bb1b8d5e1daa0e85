// Reading of a config document that its list of settings has checked. Private to experiments/config.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/math/error.hpp"
#include "core/terms/step_needs.hpp"
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
};

/// The object under a key; an empty one when absent.
inline const nlohmann::json& child(const nlohmann::json& object, const char* key) {
  static const nlohmann::json none = nlohmann::json::object();
  return object.contains(key) ? object[key] : none;
}

/// The scene section; null when it names no registered scene.
const ProceduralScene* read_scene(const nlohmann::json& object, const Reader& reader, SceneConfig& scene);

/// A config is read in three strides, which ConfigFamily takes section by section. First the scene, and the defaults that it and
/// the device decide, into a config of defaults. Then the rows of every other section. Last what sections decide and forbid
/// each other. The document has been checked, its presets and formulas are expanded. begin_config answers the registered scene, or
/// null.
const ProceduralScene* begin_config(const nlohmann::json& document, const Reader& reader, RunConfig& config);
/// d_hat, dt and the length of a run have a default only where a scene supplies it.
void require_scales(const nlohmann::json& document, const Reader& reader);
void finish_config(const nlohmann::json& document, const ProceduralScene* scene, const Reader& reader,
                   RunConfig& config);
/// A section as it stands in a resolved document; null where it does not stand. It is made from that section of the config, that of
/// `hessian` from the scene too.
nlohmann::json resolved_section(const std::string& name, const RunConfig& config);

/// What the rows of these sections alone do not express: defaults that other settings decide, and settings that
/// exclude each other. The sections have been read.
void settle_time(const nlohmann::json& object, const Reader& reader, TimeConfig& time);
void settle_formulation(const nlohmann::json& object, const Reader& reader, FormulationConfig& formulation);
void settle_strain_limit(const nlohmann::json& object, const Reader& reader,
                         const FormulationConfig& formulation, std::optional<double> default_limit,
                         StrainLimitConfig& limit);
/// The friction of a method under what the section has, where a coefficient is above 0.
void settle_friction(const nlohmann::json& object, RunConfig& config);
void settle_matching(const nlohmann::json& object, const Reader& reader, bool literal, RunConfig& config);

/// What the step solver of a config needs; all of an unknown one, which has a violation already.
StepNeeds needs_of(const RunConfig& config);

/// The step solver that a scene's protocol requires; empty: any.
std::string solver_of_protocol(const SceneConfig& scene);

/// Contradictions between sections (check_config.cpp); no JSON.
void check_contradictions(const RunConfig& config, const std::string& source,
                          std::vector<Violation>& violations);

}  // namespace bb
