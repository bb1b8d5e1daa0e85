// The verb untangle: a start in which something crosses, repaired, as a config that begins from it.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/record/phase_times.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/start/repaired_config.hpp"
#include "experiments/start/untangle.hpp"

namespace bb::cli {
namespace {

struct UntangleVerb : RunVerb {
  RepairOptions options;
};

std::string numbers_text(const RepairedStart& start, double seconds) {
  return fmt::format(
      "  method {}, {} iterations, {:.3g} s\n"
      "  displacement: at most {:.6g} m, rms {:.6g} m, by mass {:.6g} kg^1/2 m (sqrt of the sum of m |u|^2)\n"
      "  edges longer or shorter by at most {:.3g} of their length\n",
      start.method, start.iterations, seconds, start.largest, start.rms, start.mass_norm, start.strain);
}

std::string numbers_json(const RepairedStart& start, double seconds) {
  const nlohmann::json out = {{"method", start.method},
                              {"iterations", start.iterations},
                              {"seconds", seconds},
                              {"displacement_max_m", start.largest},
                              {"displacement_rms_m", start.rms},
                              {"displacement_mass_norm", start.mass_norm},
                              {"strain_max", start.strain},
                              {"slack_m", start.slack}};
  return out.dump(2) + "\n";
}

/// Of the crossings that are left: vertices that a repair would have to move and may not.
std::string held_text(const Scene& scene, const RepairedStart& start) {
  for (const StartPair& pair : start.left.crossings) {
    for (const int v : pair.vertices) {
      for (const Pin& pin : scene.pins) {
        if (pin.vertex != v) continue;
        const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(v)])];
        return fmt::format("  vertex {}[{}] is prescribed and never moves: {}\n", body.name,
                           v - body.first_vertex, pair.text);
      }
    }
  }
  return {};
}

int untangle_config(const UntangleVerb& verb) {
  const RunConfig config = load_run(verb.config, verb.set);
  require_repairable(config, verb.out);
  const Scene scene = build_scene(config);
  const double begun = now_s();
  const RepairedStart start = untangle(config, scene, verb.options);
  const double seconds = now_s() - begun;
  if (!start.repaired) {
    show("{}: no start without intersections was found, {} iterations, {:.3g} s; nothing is written\n{}{}",
         verb.config, start.iterations, seconds, start_text(scene, start.left), held_text(scene, start));
    return exit_not_clean;
  }
  write_repaired(config, scene, start.x, numbers_json(start, seconds), verb.out);
  show("{}: repaired\n{}{}\n", verb.config, numbers_text(start, seconds),
       (std::filesystem::path(verb.out) / "config.json").lexically_normal().string());
  return exit_ok;
}

}  // namespace

Action verb::untangle(CLI::App& app) {
  const auto verb = std::make_shared<UntangleVerb>();
  config_arguments(app, *verb);
  app.add_option("--out", verb->out, "folder, new, of config.json with its meshes and repair.json")
      ->required();
  app.add_option("--gap", verb->options.gap_fraction,
                 "gap that every pair has afterwards, as a part of its d_hat (default: 0.1)")
      ->check(finite_number(0, 0.9, true));
  app.add_option("--stretch", verb->options.stretch,
                 "part of its length by which an edge may be longer or shorter afterwards (default: 0.1)")
      ->check(finite_number(0, 0.9, true));
  app.add_option("--iterations", verb->options.most_iterations, "of one method, at most (default: 400)")
      ->check(CLI::Range(1, 1000000));
  return [verb](const CommonOptions&) { return untangle_config(*verb); };
}

}  // namespace bb::cli
