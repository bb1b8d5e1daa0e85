// The verb check: parses, builds the scene and looks for intersections; runs nothing.
#include <fmt/format.h>

#include "core/math/error.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/start_check.hpp"

namespace bb::cli {
namespace {

int check(const RunVerb& verb) {
  const RunConfig config = load_run(verb.config, verb.set);
  const Scene scene = build_scene(config);
  check_device_forms(config, scene);
  check_step_solver_forms(config, scene);
  if (const auto failure = start_failure(config, scene, {&interrupted()})) {
    throw ConfigError(verb.config + "#/scene", failure->detail, "a start without intersections");
  }
  fmt::print("{}: ok, {} vertices, config_id {}\n", verb.config, scene.n_vertices(), config_id(config));
  return exit_ok;
}

}  // namespace

Action verb::check(CLI::App& app) {
  const auto verb = std::make_shared<RunVerb>();
  config_arguments(app, *verb);
  return [verb](const CommonOptions&) { return cli::check(*verb); };
}

}  // namespace bb::cli
