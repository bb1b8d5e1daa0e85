#include "experiments/run/step_state.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "core/base/archive/archive.hpp"
#include "core/base/input/read_file.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/input_files.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/thread_limit.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

constexpr InputKind state_file{"the state of a step (.json, .state)", std::uint64_t{1} << 30};
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;  // of an archive
constexpr std::size_t number_bytes = sizeof(double);

/// The first bytes of all doubles, then the second ones and so on, which compresses better; and back.
std::string transposed(const std::string& bytes, bool back) {
  std::string out(bytes.size(), '\0');
  const std::size_t n = bytes.size() / number_bytes;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < number_bytes; ++k) {
      const std::size_t row = number_bytes * i + k, column = n * k + i;
      out[back ? row : column] = bytes[back ? column : row];
    }
  }
  std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(n * number_bytes), bytes.end(),
            out.begin() + static_cast<std::ptrdiff_t>(n * number_bytes));
  return out;
}

std::string deflated(const std::string& bytes) {
  const std::string rows = transposed(bytes, false);
  uLongf size = compressBound(rows.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
                rows.size(), Z_BEST_COMPRESSION) != Z_OK)
    throw std::bad_alloc();  // the only error that compress2 has here
  out.resize(size);
  return out;
}

/// Nothing where zlib does not make `bytes` of it.
std::optional<std::string> inflated(const std::string& packed, std::uint64_t bytes) {
  std::string out(bytes, '\0');
  uLongf size = bytes;
  const int code = uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                              reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (code != Z_OK || size != bytes) return std::nullopt;
  return transposed(out, true);
}

template <class T>
std::string_view bytes_of(const std::vector<T>& list) {
  return {reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T)};
}

/// Coordinates as multiples of a small part of the largest one: a libm that rounds otherwise makes the same scene. The part is no
/// decimal number, so that no coordinate of a regular mesh is half way between two multiples.
std::vector<std::int64_t> multiples(const Positions& x) {
  constexpr double fraction = 7.310585786e-7;
  const double largest = x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0;
  std::vector<std::int64_t> out(static_cast<std::size_t>(x.size()), 0);
  for (std::size_t i = 0; i < out.size() && largest > 0; ++i)
    out[i] = std::llround(x.data()[i] / (fraction * largest));
  return out;
}

/// Of what the config builds: vertices, masses, contact distances, pins and the collision surface.
std::string scene_hash(const Scene& scene) {
  RunningHash hash;
  for (const Positions* x : {&scene.rest, &scene.x0, &scene.v0}) hash.add(bytes_of(multiples(*x)));
  for (const std::vector<double>* list : {&scene.mass, &scene.d_hat, &scene.offset})
    hash.add(bytes_of(std::vector<float>(list->begin(), list->end())));
  hash.add(bytes_of(scene.surface_triangles));
  hash.add(bytes_of(scene.surface_edges));
  hash.add(bytes_of(scene.surface_vertices));
  for (const Pin& pin : scene.pins) hash.add(fmt::format("{};", pin.vertex));
  return hash.so_far().sha256;
}

json json_of(const std::optional<double>& value) { return value ? json(*value) : json(); }

json json_of(const Calibration& c) {
  return {{"kappa_N_per_m", json_of(c.kappa)},
          {"k_s_N_per_m", json_of(c.k_s)},
          {"scale", c.scale},
          {"limit_scale", c.limit_scale},
          {"limited", c.limited},
          {"solid_k_s_Pa", json_of(c.solid_k_s)}};
}

Calibration calibration_of(const json& of) {
  const auto number = [&of](const char* name) {
    return of.at(name).is_null() ? std::optional<double>() : of.at(name).get<double>();
  };
  return {number("kappa_N_per_m"),      number("k_s_N_per_m"),
          of.at("scale").get<double>(), of.at("limit_scale").get<double>(),
          of.at("limited").get<bool>(), number("solid_k_s_Pa")};
}

/// What the archive holds of the motion, which shows that it is read as it was written.
struct MotionHashes {
  std::string positions, velocities;
};

/// Errors: std::logic_error.
MotionHashes read_motion(const StepSetting& setting, const std::string& bytes) {
  Method method = make_method(setting.config, setting.calibration);
  Simulation simulation(setting.scene, method, setting.plan, setting.config.time.dt,
                        setting.config.time.steps);
  Archive archive(bytes);
  simulation.keep(archive);
  if (!archive.at_end()) throw std::logic_error("archive: more than this program keeps");
  return {state_hash(simulation.history().x), state_hash(simulation.history().v)};
}

[[noreturn]] void refuse(const fs::path& file, const std::string& found, const std::string& allowed) {
  throw ConfigError(
      file.string(), found,
      fmt::format("{}; ./bench study step-corpus --make --only {} makes the states of results/steps again",
                  allowed, file.stem().string()));
}

json read_document(const fs::path& file) {
  json document = json::parse(read_input_file(file.string(), state_file), nullptr, false);
  if (!document.is_object()) refuse(file, "no JSON object", "a file that ./bench data steps --keep wrote");
  const json schema = document.value("schema", json());
  if (schema != step_state_schema) {
    refuse(file, "schema " + schema.dump(), fmt::format("a state of this program, {}", step_state_schema));
  }
  return document;
}

std::string read_archive(const fs::path& file, const json& archive) {
  const std::string packed = read_input_file(file.string(), state_file);
  const auto bytes = archive.at("bytes").get<std::uint64_t>();
  auto out = bytes <= most_bytes ? inflated(packed, bytes) : std::nullopt;
  if (!out || sha256_hex(*out) != archive.at("sha256").get<std::string>()) {
    refuse(file, fmt::format("a state that is cut off or damaged ({} bytes)", packed.size()),
           "the file that its .json describes");
  }
  return std::move(*out);
}

/// The scene of the state and the archive are those that were kept, and this program reads them so.
void require_same(const StepState& state, const json& document) {
  if (const std::string hash = scene_hash(state.scene);
      hash != document.at("scene_sha256").get<std::string>()) {
    refuse(state.file,
           fmt::format("a state of another scene or mesh ({})",
                       document.at("scene_sha256").get<std::string>().substr(0, 12)),
           fmt::format("one of the scene that its config makes ({}, {} vertices)", hash.substr(0, 12),
                       state.scene.n_vertices()));
  }
  const StepSetting setting{state.config, state.scene, state.calibration, plan_of(state.config, state.scene)};
  try {
    const MotionHashes found = read_motion(setting, state.start.bytes);
    if (found.positions == document.at("state_hash").get<std::string>() &&
        found.velocities == document.at("velocity_hash").get<std::string>())
      return;
  } catch (const std::logic_error& error) {
    refuse(state.file, fmt::format("an archive of another build ({})", error.what()),
           "an archive of what this program keeps of a simulation");
  }
  refuse(state.file, "an archive of another build (its positions or velocities are read as others)",
         "an archive of what this program keeps of a simulation");
}

/// The two files of a state.
struct StateFiles {
  explicit StateFiles(const fs::path& stem) : document(stem), archive(stem) {
    document += ".json", archive += ".state";
  }
  /// Before the run rather than after it. Errors: RecordError.
  void check_writable() const {
    for (const fs::path* path : {&document, &archive}) {
      if (fs::is_directory(*path)) fail_with(*path, "cannot be written", EISDIR);
      const StagedFile probe(*path, "a byte");  // which goes without commit()
    }
  }
  /// Both or, where the second cannot be written, none. Errors: RecordError.
  void write(const std::string& packed, const std::string& text) const {
    StagedFile first(archive, packed), second(document, text);
    first.commit();
    try {
      second.commit();
    } catch (const RecordError&) {
      std::error_code ignored;
      fs::remove(archive, ignored);
      throw;
    }
  }
  fs::path document, archive;
};

}  // namespace

void keep_step_state(const RunConfig& config, int step, const fs::path& stem, const RunOptions& options) {
  if (step < 0 || step >= config.time.steps) {
    throw ConfigError("--at", std::to_string(step),
                      fmt::format("a step of the run, 0 to {}", config.time.steps - 1));
  }
  const StateFiles files(stem);
  files.check_writable();
  const auto threads = threads_of(config);
  const Scene scene = build_scene(config);
  MatchingRecord matching;
  const Calibration calibration = calibrate(config, scene, options, matching);
  const StepSetting setting{config, scene, calibration, plan_of(config, scene)};
  const StepStart start = step_starts(setting, {step}, "--at", options).front();
  const MotionHashes motion = read_motion(setting, start.bytes);
  const std::string packed = deflated(start.bytes);
  const json out = {
      {"schema", step_state_schema},
      {"step", step},
      {"vertices", scene.n_vertices()},
      {"free_dofs", free_dofs(scene)},
      {"scene_sha256", scene_hash(scene)},
      {"state_hash", motion.positions},
      {"velocity_hash", motion.velocities},
      {"archive",
       {{"bytes", start.bytes.size()}, {"sha256", sha256_hex(start.bytes)}, {"packed_bytes", packed.size()}}},
      {"calibration", json_of(calibration)},
      {"config", json::parse(resolved_json(name_from(stem.parent_path(), config)))}};
  files.write(packed, out.dump(1) + "\n");
}

std::vector<std::string> step_states_in(const fs::path& folder) {
  std::vector<std::string> out;
  std::error_code unreachable;
  for (const auto& entry : fs::directory_iterator(folder, unreachable)) {
    if (entry.path().extension() == ".state") out.push_back(entry.path().stem().string());
  }
  if (out.empty()) {
    throw ConfigError(folder.string(), unreachable ? "no folder that can be read" : "no state (*.state)",
                      "a folder of states, as results/steps; ./bench study step-corpus --make makes them");
  }
  std::sort(out.begin(), out.end());
  return out;
}

StepState read_step_state(const fs::path& folder, const std::string& name) {
  StepState out;
  const fs::path file = folder / (name + ".json");
  out.name = name;
  out.file = file.string();
  const json document = read_document(file);
  try {
    out.hard_for = document.value("hard_for", "");
    out.split = document.value("split", "");
    out.config = parse_config(document.at("config").dump(), out.file, folder.string());
    out.calibration = calibration_of(document.at("calibration"));
    out.start = {document.at("step").get<int>(),
                 read_archive(folder / (name + ".state"), document.at("archive"))};
    out.scene = build_scene(out.config);
    require_same(out, document);
  } catch (const json::exception& error) {
    refuse(file, fmt::format("a key that is missing or of another type ({})", error.what()),
           "a file that ./bench data steps --keep wrote");
  }
  return out;
}

}  // namespace bb
