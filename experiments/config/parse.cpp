#include "experiments/config/parse.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/input/read_file.hpp"
#include "core/base/record/provenance.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/step_solvers/registry.hpp"
#include "core/terms/step_hessian.hpp"
#include "experiments/config/document.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/formula_shapes.hpp"
#include "experiments/config/presets.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/renamed_settings.hpp"
#include "experiments/config/sections.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// 1e-4 d_hat, and never more than a tenth of the fall in one step from rest (the bound that
/// check_contradictions holds a given tolerance to).
double default_tolerance(const RunConfig& config) {
  const double dt = config.time.dt;
  const double fall = 0.5 * largest_gravity(config.scene.gravity, config.scene.gravity_keys) * dt * dt;
  const double length = 1e-4 * config.formulation.d_hat;
  return (fall > 0 && config.integrator.name != "quasi_static" ? std::min(length, 0.1 * fall) : length) / dt;
}

/// What is left out: a step solver that tests energies goes down from any state, the others keep to
/// matrices that are positive semi-definite term by term.
void fill_hessians(const json& document, RunConfig& config) {
  const bool minimum = needs_of(config).minimum;
  if (minimum && !child(document, "contact").contains("hessian_mode")) {
    config.contact.hessian_mode = HessianMode::projected_full;
  }
  const StepHessian fallback = minimum ? StepHessian::blend : StepHessian::clamped;
  for (const HessianChoice& choice : hessian_choices()) {
    config.hessian.parameters.try_emplace(choice.name, std::string(to_string(fallback)));
  }
}

}  // namespace

void require_scales(const json& document, const Reader& reader) {
  if (!child(document, "formulation").contains("d_hat_m")) {
    reader.missing("/formulation/d_hat_m", "a number > 0 (m): a scene given as bodies has no default");
  }
  const json& time = child(document, "time");
  if (!time.contains("dt_s")) {
    reader.missing("/time/dt_s", "a value: a scene given as bodies has no default");
  }
  if (!time.contains("steps") && !time.contains("duration_s")) {
    reader.missing("/time/steps", "a value, or duration_s: a scene given as bodies has no default");
  }
}

const ProceduralScene* begin_config(const json& document, const Reader& reader, RunConfig& config) {
  config.source = reader.source;
  config.name = document.value("name", "");
  const ProceduralScene* scene = read_scene(child(document, "scene"), reader, config.scene);
  const SceneDefaults defaults = scene ? scene->defaults : SceneDefaults();
  config.time = {defaults.dt, defaults.steps};
  config.formulation.d_hat = defaults.d_hat;
  if (const std::string solver = solver_of_protocol(config.scene); !solver.empty())
    config.step_solver.name = solver;
  if (document.value("device", word_of(Device::cpu)) != word_of(Device::cpu)) {
    config.linear_solver.name = linear_solver_at(MatrixPlace::executor).name;
  }
  return scene;
}

void finish_config(const json& document, const ProceduralScene* scene, const Reader& reader,
                   RunConfig& config) {
  const SceneDefaults defaults = scene ? scene->defaults : SceneDefaults();
  const json& time = child(document, "time");
  if (!config.method.empty() && scene && !time.contains("steps") && !time.contains("duration_s")) {
    config.time.duration = defaults.dt * defaults.steps;  // whatever dt the method has
  }
  settle_time(time, reader, config.time);
  settle_formulation(child(document, "formulation"), reader, config.formulation);
  settle_strain_limit(child(document, "strain_limit"), reader, config.formulation, defaults.limit,
                      config.strain_limit);
  settle_friction(child(document, "friction"), config);
  settle_matching(child(document, "matching"), reader, !solver_of_protocol(config.scene).empty(), config);
  if (!child(document, "step_solver").contains("tol_velocity_m_per_s")) {
    config.step_solver.tol_velocity = default_tolerance(config);
  }
  if (!child(document, "step_solver").contains("saddle") && !needs_of(config).minimum) {
    config.step_solver.saddle = SaddleRule::ignore;
  }
  fill_hessians(document, config);
  check_contradictions(config, reader.source, reader.violations);
}

namespace {

RunConfig read_document(json document, const std::string& source, std::vector<Violation>& violations) {
  RunConfig config;
  const std::size_t before = violations.size();
  if (!check_value(document, settings_of<RunConfig>().rule(), source + "#", violations)) {
    document = json::object();
  }
  for (const char* section : {"formulation", "strain_limit"}) {
    if (document.contains(section)) name_formula(document[section], source + "#/" + section, violations);
  }
  const Reader reader{source, violations, violations.size() == before};
  if (document.contains("formulation")) expand_preset(document["formulation"], source, violations);

  const ProceduralScene* scene = begin_config(document, reader, config);
  if (config.scene.name == "bodies") require_scales(document, reader);
  settings_of<RunConfig>().read(document, config);
  finish_config(document, scene, reader, config);
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
  const std::string source = path == "-" ? "the standard input" : path;
  const std::string text = read_input_file(path, config_file);
  note_earlier_names(text, overrides);
  return parse_config(text, source, folder.empty() ? "." : folder, overrides);
}

namespace {

/// Settings of step solvers that came later than ids that are known stand where a solver is chosen that has them.
void leave_out_later_settings(const RunConfig& config, json& out) {
  const auto stated = [&](const Parameter& row) {
    return std::any_of(step_solvers().begin(), step_solvers().end(), [&](const StepSolverEntry& entry) {
      return (entry.stated_always || entry.name == config.step_solver.name) &&
             find_named(entry.parameters, row.name) != nullptr;
    });
  };
  for (const StepSolverEntry& entry : step_solvers()) {
    for (const Parameter& own : entry.parameters) {
      if (!stated(own)) out.erase(own.name);
    }
  }
}

/// A scene without pressure, or without stitches that have a length, has no choice of their Hessian, and the id that it had
/// before there was one.
void leave_out_unused_hessians(const RunConfig& config, json& out) {
  const auto presses = [](const BodyConfig& body) {
    return body.spec.pressure != 0 || !body.spec.pressure_keys.empty();
  };
  if (std::none_of(config.scene.bodies.begin(), config.scene.bodies.end(), presses)) out.erase("inflation");
  const auto has_length = [](const StitchSpec& stitch) { return stitch.rest_length > 0; };
  if (std::none_of(config.scene.stitches.begin(), config.scene.stitches.end(), has_length))
    out.erase("stitch");
}

}  // namespace

json resolved_section(const std::string& name, const RunConfig& config) {
  json out = settings_of<RunConfig>().write_one(name, config);
  if (name == "step_solver") leave_out_later_settings(config, out);
  if (name == "hessian") leave_out_unused_hessians(config, out);
  use_recorded_names(name, out);
  return out;
}

json settings_document(const RunConfig& config) {
  json out = settings_of<RunConfig>().write(config);
  leave_out_later_settings(config, out["step_solver"]);
  leave_out_unused_hessians(config, out["hessian"]);
  return out;
}

json resolved_document(const RunConfig& config) {
  json out = settings_document(config);
  for (const auto& [name, section] : out.items()) use_recorded_names(name, section);
  return out;
}

std::string resolved_json(const RunConfig& config) { return resolved_document(config).dump(2); }

std::string config_id(const RunConfig& config) { return config_id_of(resolved_document(config)); }

}  // namespace bb
