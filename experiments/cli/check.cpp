#include <fmt/format.h>

#include "core/math/error.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/run/start_check.hpp"

namespace bb::cli {

int check(const RunVerb& verb) {
  const RunConfig config = load_config(verb.config, verb.set);
  const Scene scene = build_scene(config);
  if (const auto overlap = initial_intersection(config, scene)) {
    throw ConfigError(verb.config + "#/scene", *overlap, "a start without intersections");
  }
  fmt::print("{}: ok, {} vertices, config_id {}\n", verb.config, scene.n_vertices(), config_id(config));
  return exit_ok;
}

int explain(const RunVerb& verb) {
  const RunConfig config = load_config(verb.config, verb.set);
  const Scene scene = build_scene(config);
  const Plan plan = plan_of(config, scene);
  fmt::print("{}\n  {} vertices ({} prescribed), {} membrane triangles, {} steps of {} s\n\n",
             run_label(config), scene.n_vertices(), scene.pins.size(), scene.membrane.triangles.size(),
             config.time.steps, config.time.dt);
  for (const bool needed : {true, false}) {
    fmt::print("{}\n", needed ? "runs" : "skipped");
    for (const auto& [name, item] : plan.items()) {
      if (item->needed == needed) fmt::print("  {:<18} {}\n", name, item->reason);
    }
  }
  return exit_ok;
}

}  // namespace bb::cli
