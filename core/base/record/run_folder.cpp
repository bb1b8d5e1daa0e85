#include "core/base/record/run_folder.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "core/base/input/json.hpp"
#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Folders of what is written beside a record.
constexpr std::array artifact_folders = {"frames", "forces", "matrices"};

/// The names of the files in them, below the folder of a run.
bool is_artifact_name(const std::string& relative) {
  static const std::regex name(
      R"(frames/(scene\.json|start\.ply|step_\d{6,}\.ply)|forces/pairs\.csv|matrices/step_\d{6,}_iteration_\d{3,}(_exact)?\.(mtx|json))");
  return std::regex_match(relative, name);
}

bool is_unfinished_name(const std::string& name) {
  return name == "trace.jsonl.part" || name == "checkpoint.bin" || name == "checkpoint.next.bin" ||
         name == "checkpoint.log";
}

/// A file that was being written.
bool is_temporary_name(const std::string& name) {
  static const std::regex pattern(
      R"((run\.json|run\.json\.part|sweep\.json|cases\.json|probe|checkpoint\.bin)\.tmp\.\d+)");
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
  for (const std::string kind : artifact_folders) {
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
  for (const std::string kind : artifact_folders) {
    const fs::path part = folder / (kind + ".part");
    remove_files(part, [&kind](const std::string& name) {
      return is_artifact_name(kind + "/" + name.substr(0, name.find(".tmp.")));
    });
    fs::remove(part, error);  // fails, as it should, when something else lies in it
  }
}

namespace {

/// The artifacts that the record in `file` names: relative path, SHA-256. None when it cannot be read, or is torn.
std::vector<std::pair<std::string, std::string>> artifacts_of(const fs::path& file) {
  std::vector<std::pair<std::string, std::string>> out;
  json record;
  try {
    record = parse_json(read_input_file(file.string(), record_file), file.string(), LargeIntegers::rounded);
  } catch (const ConfigError&) {
    return out;
  }
  if (!record.is_object() || !record.contains("artifacts")) return out;
  for (const json& artifact : record["artifacts"]) {
    if (!artifact.is_object() || !artifact.contains("path") || !artifact["path"].is_string()) continue;
    if (!artifact.contains("sha256") || !artifact["sha256"].is_string()) continue;
    const auto relative = artifact["path"].get<std::string>();
    if (is_artifact_name(relative)) out.emplace_back(relative, artifact["sha256"].get<std::string>());
  }
  return out;
}

}  // namespace

// The record goes last: while it is there, what has the names of its files is of the earlier run.
void remove_earlier_run(const fs::path& folder) {
  std::error_code error;
  for (const auto& [relative, sha256] : artifacts_of(folder / "run.json")) {
    const fs::path file = folder / relative;
    if (sha256 != sha256_file(file.string())) continue;
    fs::remove(file, error);
    fs::remove(file.parent_path(), error);  // once it is empty
  }
  for (const char* name : {"trace.jsonl", "run.json"}) fs::remove(folder / name, error);
}

fs::path pending_record(const fs::path& folder) { return folder / "run.json.part"; }

bool put_in_place(const fs::path& folder) {
  const fs::path pending = pending_record(folder), record = folder / "run.json";
  std::error_code error;
  if (!fs::exists(pending, error)) return false;
  if (fs::exists(record, error)) remove_earlier_run(folder);  // else some files are in their places already
  const auto move_if_there = [&](const fs::path& from, const fs::path& to) {
    if (fs::exists(from, error)) move_into_place(from, to);
  };
  move_if_there(folder / "trace.jsonl.part", folder / "trace.jsonl");
  for (const auto& [relative, sha256] : artifacts_of(pending)) {
    move_if_there(folder / part_of(relative), folder / relative);
  }
  remove_unfinished_artifacts(folder);
  move_into_place(pending, record);
  return true;
}

}  // namespace bb
