#include "experiments/run/input_files.hpp"

#include "core/base/input/read_file.hpp"
#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;

/// The name of the file itself stays: its suffix may be lost behind a link.
std::string relative_name(const fs::path& folder, const fs::path& file) {
  const fs::path place = fs::weakly_canonical(fs::absolute(file).parent_path()) / file.filename();
  return place.lexically_relative(fs::weakly_canonical(fs::absolute(folder))).generic_string();
}

/// Unless the copy is there. Errors: ConfigError for a file that has changed.
void copy_bytes(const std::string& file, const InputKind& kind, const std::string& sha256,
                const fs::path& to) {
  if (sha256_file(to.string()) == sha256) return;
  const std::string bytes = read_input_file(file, kind);
  if (sha256_hex(bytes) != sha256) {
    throw ConfigError(file, "another content than when it was first read", "sha256 " + sha256);
  }
  write_atomically(to, bytes);
}

void copy_one(const fs::path& folder, const InputKind& kind, std::string& file, const std::string& sha256) {
  const std::string prefix = sha256.substr(0, 8) + "-", name = fs::path(file).filename().string();
  const fs::path copy = folder / "inputs" / (name.starts_with(prefix) ? name : prefix + name);
  copy_bytes(file, kind, sha256, copy);
  file = copy.string();
}

/// Into a folder of its own, since a film is known by the names of its files.
void copy_film(const fs::path& folder, FilmSource& film) {
  if (film.files.empty()) return;
  const fs::path copies = folder / "inputs" / ("film-" + film.sha256.substr(0, 8));
  const auto copy = [&copies](HashedFile& file) {
    if (file.path.empty()) return;
    const fs::path to = copies / fs::path(file.path).filename();
    copy_bytes(file.path, mesh_file, file.sha256, to);
    file.path = to.string();
  };
  for (HashedFile& file : film.files) copy(file);
  copy(film.times_file);
}

}  // namespace

RunConfig name_from(const fs::path& folder, RunConfig config) {
  for (BodyConfig& body : config.scene.bodies) {
    for (MeshSource* mesh : {&body.mesh, &body.rest_mesh}) {
      if (!mesh->file.empty()) mesh->file = relative_name(folder, mesh->file);
    }
    for (WeightGroupConfig& group : body.weights) {
      if (!group.file.path.empty()) group.file.path = relative_name(folder, group.file.path);
    }
    for (FilmSource* film : films_of(body)) {
      for (HashedFile& file : film->files) file.path = relative_name(folder, file.path);
      std::string& times = film->times_file.path;
      if (!times.empty()) times = relative_name(folder, times);
    }
  }
  return config;
}

std::vector<PluginFile> name_from(const fs::path& folder, std::vector<PluginFile> plugins) {
  for (PluginFile& plugin : plugins) plugin.file = relative_name(folder, plugin.file);
  return plugins;
}

void copy_inputs(const fs::path& folder, RunConfig& config, std::vector<PluginFile>& plugins) {
  for (BodyConfig& body : config.scene.bodies) {
    for (MeshSource* mesh : {&body.mesh, &body.rest_mesh}) {
      if (!mesh->file.empty()) copy_one(folder, mesh_file, mesh->file, mesh->sha256);
    }
    for (WeightGroupConfig& group : body.weights) {
      if (!group.file.path.empty()) copy_one(folder, weights_file, group.file.path, group.file.sha256);
    }
    for (FilmSource* film : films_of(body)) copy_film(folder, *film);
  }
  for (PluginFile& plugin : plugins) copy_one(folder, plugin_file, plugin.file, plugin.sha256);
}

}  // namespace bb
