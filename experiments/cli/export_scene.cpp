// The verb export-scene: the scene of a config for engines of others, on the standard output.
#include <fmt/format.h>

#include "experiments/cli/options.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/neutral_scene.hpp"
#include "experiments/run/plan.hpp"

namespace bb::cli {

Action verb::export_scene(CLI::App& app) {
  const auto verb = std::make_shared<RunVerb>();
  config_arguments(app, *verb);
  return [verb](const CommonOptions&) {
    const RunConfig config = load_run(verb->config, verb->set);
    const Scene scene = build_scene(config);
    fmt::print("{}\n", neutral_scene(config, scene, plan_of(config, scene)).dump());
    return exit_ok;
  };
}

}  // namespace bb::cli
