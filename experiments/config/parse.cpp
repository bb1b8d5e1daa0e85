#include "experiments/config/parse.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/input/read_file.hpp"
#include "experiments/config/document.hpp"
#include "experiments/config/presets.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/schema_check.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// d_hat and dt have a default only where a scene supplies it.
void require_scales(const json& document, const Reader& reader) {
  if (!child(document, "formulation").contains("d_hat_m")) {
    reader.missing("/formulation/d_hat_m", "a number > 0 (m): a scene given as bodies has no default");
  }
  for (const char* key : {"dt_s", "steps"}) {
    if (!child(document, "time").contains(key)) {
      reader.missing(std::string("/time/") + key, "a value: a scene given as bodies has no default");
    }
  }
}

RunConfig read_document(json document, const std::string& source, std::vector<Violation>& violations) {
  RunConfig config;
  config.source = source;
  const std::size_t before = violations.size();
  check_schema(document, config_schema(), source, violations);
  const Reader reader{source, violations, violations.size() == before};
  if (document.contains("formulation")) expand_preset(document["formulation"], source, violations);

  const ProceduralScene* scene = read_scene(child(document, "scene"), reader, config.scene);
  const SceneDefaults defaults = scene ? scene->defaults : SceneDefaults();
  if (config.scene.name == "bodies") require_scales(document, reader);
  const auto protocol = config.scene.parameters.find("protocol");
  const bool literal = protocol != config.scene.parameters.end() &&
                       protocol->second == ParameterValue(std::string("article_literal"));

  read_formulation(child(document, "formulation"), reader, defaults.d_hat, config.formulation);
  read_strain_limit(child(document, "strain_limit"), reader, config.formulation, defaults.limit,
                    config.strain_limit);
  read_matching(child(document, "matching"), reader, literal, config);
  read_pipeline(document, reader, defaults, literal, config);
  check_contradictions(config, source, violations);
  return config;
}

}  // namespace

RunConfig parse_config(const std::string& text, const std::string& source, const std::string& folder,
                       std::span<const std::string> overrides) {
  std::vector<Violation> violations;
  json document = make_document(text, source, folder, overrides, violations);
  RunConfig config = read_document(std::move(document), source, violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  return config;
}

RunConfig load_config(const std::string& path, std::span<const std::string> overrides) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return parse_config(read_input_file(path, config_file), path, folder.empty() ? "." : folder, overrides);
}

}  // namespace bb
