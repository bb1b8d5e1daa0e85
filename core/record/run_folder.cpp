#include "core/record/run_folder.hpp"

#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "core/input/json.hpp"
#include "core/record/provenance.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The names of frames and matrices, below the folder of a run.
bool is_artifact_name(const std::string& relative) {
  static const std::regex name(
      R"(frames/(scene\.json|start\.ply|step_\d{6,}\.ply)|matrices/step_\d{6,}_iteration_\d{3,}(_exact)?\.(mtx|json))");
  return std::regex_match(relative, name);
}

bool is_unfinished_name(const std::string& name) {
  return name == "trace.jsonl.part" || name == "checkpoint.bin";
}

/// A file that was being written.
bool is_temporary_name(const std::string& name) {
  static const std::regex pattern(R"((run\.json|sweep\.json|probe|checkpoint\.bin)\.tmp\.\d+)");
  return std::regex_match(name, pattern);
}

/// The files of `folder` whose names `is_ours` knows; nothing when it cannot be listed.
template <class Predicate>
void remove_files(const fs::path& folder, Predicate is_ours) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->is_regular_file(error) && is_ours(it->path().filename().string())) found.push_back(it->path());
  }
  for (const fs::path& file : found) fs::remove(file, error);
}

}  // namespace

fs::path part_of(const fs::path& relative) {
  const auto first = relative.begin();
  fs::path out = first->string() + ".part";
  for (auto it = std::next(first); it != relative.end(); ++it) out /= *it;
  return out;
}

void remove_temporaries(const fs::path& folder) {
  remove_files(folder, is_temporary_name);
  for (const std::string kind : {"frames", "matrices"}) {
    remove_files(folder / (kind + ".part"), [&kind](const std::string& name) {
      const std::size_t end = name.find(".tmp.");
      return end != std::string::npos && is_artifact_name(kind + "/" + name.substr(0, end));
    });
  }
}

void remove_unfinished(const fs::path& folder) {
  remove_temporaries(folder);
  remove_files(folder, is_unfinished_name);
  remove_unfinished_artifacts(folder);
}

void remove_unfinished_artifacts(const fs::path& folder) {
  std::error_code error;
  for (const std::string kind : {"frames", "matrices"}) {
    const fs::path part = folder / (kind + ".part");
    remove_files(part, [&kind](const std::string& name) {
      return is_artifact_name(kind + "/" + name.substr(0, name.find(".tmp.")));
    });
    fs::remove(part, error);  // fails, as it should, when something else lies in it
  }
}

void remove_earlier_run(const fs::path& folder) {
  std::error_code error;
  json record;
  try {
    const std::string file = (folder / "run.json").string();
    record = parse_json(read_input_file(file, record_file), file, LargeIntegers::rounded);
  } catch (const ConfigError&) {  // none, or a torn one
  }
  const json none = json::array();
  const json& artifacts = record.is_object() && record.contains("artifacts") ? record["artifacts"] : none;
  for (const json& artifact : artifacts) {
    if (!artifact.is_object() || !artifact.contains("path") || !artifact["path"].is_string()) continue;
    const auto relative = artifact["path"].get<std::string>();
    const fs::path file = folder / relative;
    if (!is_artifact_name(relative) || !artifact.contains("sha256")) continue;
    if (artifact["sha256"] != sha256_file(file.string())) continue;
    fs::remove(file, error);
    fs::remove(file.parent_path(), error);  // once it is empty
  }
  for (const char* name : {"run.json", "trace.jsonl"}) fs::remove(folder / name, error);
}

}  // namespace bb
