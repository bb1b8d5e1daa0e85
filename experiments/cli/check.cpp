// The verb check: parses, builds the scene and looks for intersections; says how large things are; runs nothing.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "core/base/input/names.hpp"
#include "core/base/input/read_file.hpp"
#include "core/base/record/run_folder.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/terminal.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/artifacts.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "experiments/run/device_memory.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/prescribed_crossings.hpp"
#include "experiments/run/start_check.hpp"
#include "experiments/start/start_report.hpp"

namespace bb::cli {
namespace {

struct CheckVerb : RunVerb {
  bool film = false;
  std::string pairs, marks;  // files that are written
};

constexpr std::size_t most_bodies = 20;

/// Edges of one body's surface and rods at the start, m.
struct EdgeLengths {
  double least = std::numeric_limits<double>::infinity(), largest = 0, sum = 0;
  std::size_t n = 0;

  void add(double length) {
    least = std::min(least, length);
    largest = std::max(largest, length);
    sum += length;
    ++n;
  }
  double mean() const { return sum / static_cast<double>(n); }
};

std::vector<EdgeLengths> edge_lengths(const Scene& scene) {
  std::vector<EdgeLengths> of(scene.bodies.size());
  for (const auto& [a, b] : scene.surface_edges) {
    const auto body = static_cast<std::size_t>(scene.body[static_cast<std::size_t>(a)]);
    if (body < of.size()) of[body].add((scene.x0.col(a) - scene.x0.col(b)).norm());
  }
  return of;
}

std::string edges_text(const EdgeLengths& edges, double d_hat, double offset) {
  if (edges.n == 0) return "no edge on its surface";
  std::string out =
      fmt::format("{} edges of {:.3g} to {:.3g} m, mean {:.3g} m; d_hat {:.3g} m is {:.2g} of the mean edge",
                  edges.n, edges.least, edges.largest, edges.mean(), d_hat, d_hat / edges.mean());
  if (offset > 0) out += fmt::format(", offset {:.3g} m", offset);
  if (d_hat + 2 * offset > edges.least) out += "; that is more than the shortest edge";
  return out;
}

/// The objects and groups of the mesh files of the first bodies, once for each file, which a config can name.
void print_objects(const RunConfig& config) {
  std::set<std::string> files;
  for (std::size_t i = 0; i < std::min(most_bodies, config.scene.bodies.size()); ++i) {
    const std::string& file = config.scene.bodies[i].mesh.file;
    if (file.empty() || !files.insert(file).second) continue;
    const MeshObjects objects = parse_mesh_objects(read_input_file(file, mesh_file), file);
    if (objects.empty()) continue;
    std::vector<std::string> names;
    for (const MeshObject& one : objects.list) {
      names.push_back(
          fmt::format("{} ({} vertices)", printable(shortened(one.name)), objects.file_vertices(one).size()));
    }
    print_wrapped(fmt::format("  objects and groups of {}: {}{}", printable(file), listed(names),
                              names.size() > most_listed ? "; the verb meshes has all of their names" : ""),
                  4);
  }
}

/// Box of all bodies at the start, the edges of each, and what the files have names for.
void print_sizes(const RunConfig& config, const Scene& scene) {
  const auto start = scene.x0.leftCols(scene.n_body_vertices());
  if (start.cols() == 0) return;
  const Vec3d low = start.rowwise().minCoeff(), high = start.rowwise().maxCoeff(), size = high - low;
  show(
      "  bounding box {:.4g} x {:.4g} x {:.4g} m, from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) "
      "m\n",
      size.x(), size.y(), size.z(), low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
  const std::vector<EdgeLengths> edges = edge_lengths(scene);
  for (std::size_t i = 0; i < std::min(most_bodies, scene.bodies.size()); ++i) {
    const Body& body = scene.bodies[i];
    const auto first = static_cast<std::size_t>(body.first_vertex);
    show("  body {}: {} vertices, {}\n", body.name, body.n_vertices,
         edges_text(edges[i], scene.d_hat[first], scene.offset[first]));
  }
  if (scene.bodies.size() > most_bodies) show("  and {} more bodies\n", scene.bodies.size() - most_bodies);
  print_objects(config);
}

/// The start as the files of a frame that a run leaves. Errors: ConfigError where there are frames already; RecordError.
void write_start(const Scene& scene, const std::filesystem::path& folder) {
  std::error_code unreachable;
  if (std::filesystem::exists(folder / "frames", unreachable))
    throw ConfigError("--start-frame", "\"" + (folder / "frames").string() + "\", which is there already",
                      "a folder without frames");
  ArtifactWriter writer(folder, scene);
  writer.start();
  writer.leave_unfinished();
  std::error_code error;
  std::filesystem::rename(folder / part_of("frames"), folder / "frames", error);
  if (error) throw ConfigError("--start-frame", error.message(), "a folder that can be written");
}

void print_contacts(const DeviceMemory& memory) {
  print_wrapped(fmt::format("  on the device: {:.4g} contacts ({}), {} at the peak of a step; bench explain "
                            "has it by buffer",
                            memory.contacts, memory.source, exec::bytes_text(memory.total)),
                4);
}

constexpr std::size_t most_crossings = 20;

/// The films of a scene, and where along all of them prescribed parts cross. Errors: ConfigError where they do.
void check_films(const std::string& file, const RunConfig& config, const Scene& scene) {
  std::string films;
  for (const PrescribedMotion& motion : scene.motions) {
    if (!motion.film) continue;
    const Film& film = *motion.film;
    const auto body = static_cast<std::size_t>(scene.body[static_cast<std::size_t>(motion.first_vertex)]);
    films += fmt::format("  film of {}: {} frames of {} vertices, {:.6g} to {:.6g} s, {}\n",
                         scene.bodies[body].name, film.n_frames(), film.n_vertices(), film.times().front(),
                         film.times().back(), word_of(motion.film_source.between));
  }
  if (films.empty()) {
    throw ConfigError(file + "#/scene", "no film", "a body or pins whose motion has one, for --film");
  }
  const int steps = steps_of_motions(scene, config.time.dt);
  const auto found = prescribed_crossings(config, scene, steps, most_crossings, {&interrupted()});
  std::vector<Violation> violations;
  for (const PrescribedCrossing& one : found) {
    violations.push_back({file + "#/scene",
                          fmt::format("{}, from {:.6g} to {:.6g} s", one.pair, one.t0, one.t1),
                          "prescribed parts that do not cross each other"});
  }
  if (!violations.empty()) throw ConfigError(std::move(violations));
  show("{}  no prescribed part crosses another in {} steps of {:g} s, to the end of the last motion\n", films,
       steps, config.time.dt);
}

/// What crosses and what is near in the start, in words; the files that were requested are written.
std::string pairs_of(const CheckVerb& verb, const RunConfig& config, const Scene& scene) {
  const StartReport report = report_start(config, scene, audit_mesh_of(config, scene), scene.x0);
  if (!verb.pairs.empty()) write_atomically(verb.pairs, start_csv(scene, report));
  if (!verb.marks.empty()) write_atomically(verb.marks, marked_start(scene, report));
  const bool whole = report.clean() || !verb.pairs.empty();
  return start_text(scene, report) + (whole ? "" : "  --pairs FILE.csv lists all of them\n");
}

int check(const CheckVerb& verb) {
  const RunConfig config = load_run(verb.config, verb.set);
  const Scene scene = build_scene(config);
  const Plan plan = plan_of(config, scene);
  if (!verb.out.empty()) write_start(scene, verb.out);
  check_device_forms(config, scene);
  check_step_solver_forms(config, scene);
  if (verb.film) check_films(verb.config, config, scene);
  if (const auto failure = start_failure(config, scene, plan.contacts, {&interrupted()})) {
    say(pairs_of(verb, config, scene));
    throw ConfigError(verb.config + "#/scene", failure->detail, "a start without intersections");
  }
  show("{}: ok, {} vertices, config_id {}\n", verb.config, scene.n_vertices(), config_id(config));
  print_sizes(config, scene);
  show_text(pairs_of(verb, config, scene));
  if (config.device != Device::cpu) print_contacts(count_device_memory(config, scene, plan, {}));
  return exit_ok;
}

}  // namespace

Action verb::check(CLI::App& app) {
  const auto verb = std::make_shared<CheckVerb>();
  config_arguments(app, *verb);
  app.add_option(
      "--start-frame", verb->out,
      "write the start as DIR/frames/start.ply and scene.json, also where something crosses; ./bench "
      "render CONFIG draws it");
  app.add_option(
      "--pairs", verb->pairs,
      "write every pair that crosses at the start, or is nearer than its d_hat, as a line of FILE.csv");
  app.add_option(
      "--export", verb->marks,
      "write the start as FILE.ply with columns of its vertices, crossing and near, which are 1 where a "
      "pair of --pairs has the vertex; ./bench draw still CONFIG --color crossing draws them");
  app.add_flag(
      "--film", verb->film,
      "report what films the scene has, and follow all of them, to their ends: every time and pair at which "
      "prescribed parts cross, not the first alone");
  return [verb](const CommonOptions&) { return cli::check(*verb); };
}

}  // namespace bb::cli
