#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/input/read_file.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/config/document.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/run/start_check.hpp"

namespace bb::cli {

namespace {

/// The policy with what the config gives of its parameters.
std::string stiffness_text(const PolicyConfig& policy) {
  std::string out = policy.name;
  for (const auto& [name, value] : policy.parameters) out += fmt::format(", {} {}", name, to_text(value));
  if (policy.scale != 1) out += fmt::format(", times {:g}", policy.scale);
  return out;
}

void print_formulation(const RunConfig& config) {
  const FormulationConfig& contact = config.formulation;
  const StrainLimitConfig& limit = config.strain_limit;
  fmt::print("contact   {} on {}, d_hat {:g} m, {}\n", contact.shape, to_string(contact.argument),
             contact.d_hat, stiffness_text(contact.stiffness_policy));
  if (limit.enabled) {
    fmt::print("limit     {} on {}, onset {:g}, width {:g}, {}\n", limit.shape, to_string(limit.argument),
               limit.onset, limit.width, stiffness_text(limit.stiffness_policy));
  }
  fmt::print("matching  {}{}\n\n", to_string(config.matching.rule),
             config.matching.rule == MatchingRule::as_given
                 ? ""
                 : fmt::format(", theta {:g}: a given stiffness is replaced", config.matching.theta));
}

/// One line a number, word or list of the resolved config: pointer, value, and where the value is from.
void print_settings(const RunVerb& verb, const RunConfig& config) {
  std::vector<Violation> ignored;  // load_config has judged the same text
  const std::string folder = std::filesystem::path(verb.config).parent_path().string();
  const nlohmann::json given =
      make_document(read_input_file(verb.config, config_file), verb.config, folder, verb.set, ignored);
  const nlohmann::json flat = nlohmann::json::parse(resolved_json(config)).flatten();
  fmt::print("\nevery setting of the run (* given by the config or --set; the others are defaults)\n");
  for (const auto& [pointer, value] : flat.items()) {
    const bool own = given.contains(nlohmann::json::json_pointer(pointer));
    fmt::print("  {} {:<52} {}\n", own ? '*' : ' ', pointer, value.dump());
  }
}

}  // namespace

int check(const RunVerb& verb) {
  const RunConfig config = load_run(verb.config, verb.set);
  const Scene scene = build_scene(config);
  if (const auto failure = start_failure(config, scene, &interrupted())) {
    throw ConfigError(verb.config + "#/scene", failure->detail, "a start without intersections");
  }
  fmt::print("{}: ok, {} vertices, config_id {}\n", verb.config, scene.n_vertices(), config_id(config));
  return exit_ok;
}

int explain(const RunVerb& verb) {
  const RunConfig config = load_run(verb.config, verb.set);
  const Scene scene = build_scene(config);
  const Plan plan = plan_of(config, scene);
  fmt::print("{}\n  {} vertices ({} prescribed), {} membrane triangles, {} steps of {} s\n\n",
             run_label(config), scene.n_vertices(), scene.pins.size(), scene.membrane_triangles().size(),
             config.time.steps, config.time.dt);
  print_formulation(config);
  for (const bool needed : {true, false}) {
    fmt::print("{}\n", needed ? "runs" : "skipped");
    for (const auto& [name, item] : plan.items()) {
      if (item->needed == needed) fmt::print("  {:<18} {}\n", name, item->reason);
    }
  }
  print_settings(verb, config);
  return exit_ok;
}

}  // namespace bb::cli
