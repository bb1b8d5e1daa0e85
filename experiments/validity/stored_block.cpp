#include "experiments/validity/stored_block.hpp"

#include <nlohmann/json.hpp>

#include "core/base/input/read_file.hpp"
#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"
#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* schema = "barrierbench.validity/1";

Json check_json(const BlockCheck& check) {
  Json j;
  j["name"] = check.name;
  j["meaning"] = check.meaning;
  j["subjects"] = check.subjects;
  j["value"] = check.value.finite() ? Json(check.value.value) : Json();
  if (!check.value.finite()) j["value_status"] = check.value.status;
  j["bound"] = check.bound;
  j["pass"] = check.pass();
  j["detail"] = check.detail;
  return j;
}

BlockCheck check_of(const Json& j) {
  BlockCheck check;
  check.name = j.at("name").get<std::string>();
  check.bound = j.at("bound").get<double>();
  check.value = j.at("value").is_null() ? Number::missing("not_finite") : Number(j.at("value").get<double>());
  check.subjects = j.at("subjects").get<long long>();
  check.detail = j.at("detail").get<std::string>();
  return check;
}

/// What a stored report holds, if it is one of this build with exactly the checks of the block. `pass` is not read: it
/// follows from the numbers.
std::optional<BuildValidity> read_report(const std::filesystem::path& file, const BuildKey& build,
                                         std::string& text) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  try {
    text = read_input_file(file.string(), record_file);
    const Json j = Json::parse(text);
    if (j.at("schema") != schema || j.at("build") != build.text) return std::nullopt;
    std::vector<BlockCheck> checks;
    std::vector<std::string> names;
    for (const Json& check : j.at("checks")) {
      checks.push_back(check_of(check));
      names.push_back(checks.back().name);
    }
    if (names != block_names()) return std::nullopt;
    return summary_of(checks, text);
  } catch (const std::exception&) {  // unreadable, no JSON, another type: made anew
    return std::nullopt;
  }
}

}  // namespace

BuildKey this_build(const std::vector<PluginFile>& plugins) {
  RunRecord record;
  record.provenance = collect_provenance({}, 1);
  record.machine = collect_machine();
  record.provenance.plugins = plugins;
  record.config.text = "{}";
  fill_ids(record);  // with an empty config and one thread the run_id is that of build and machine
  std::string text = record.ids.run_id;
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (entry.missing && entry.missing().empty()) text += " with " + entry.name;
  }
  return {text, sha256_hex(text)};
}

std::string report_text(const BuildKey& build, const std::vector<BlockCheck>& checks) {
  Json j;
  j["schema"] = schema;
  j["build"] = build.text;
  j["git_commit"] = collect_provenance({}, 1).git_commit;
  j["made_utc"] = utc_now();
  j["checks"] = Json::array();
  for (const BlockCheck& check : checks) j["checks"].push_back(check_json(check));
  return j.dump(1) + "\n";
}

BuildValidity summary_of(const std::vector<BlockCheck>& checks, const std::string& report) {
  BuildValidity out;
  out.checks = static_cast<int>(checks.size());
  for (const BlockCheck& check : checks) {
    if (!check.pass()) out.failed += (out.failed.empty() ? "" : ", ") + check.name;
  }
  out.valid = !checks.empty() && out.failed.empty();
  out.report_sha256 = sha256_hex(report);
  return out;
}

namespace {

/// Whether there is a report of this build, which is read.
bool read_stored(const BuildKey& build, StoredBlock& out) {
  const auto stored = read_report(out.file, build, out.report);
  if (!stored) return false;
  out.validity = *stored;
  out.kept = true;
  return true;
}

}  // namespace

StoredBlock block_of_this_build(const std::filesystem::path& folder, const std::vector<PluginFile>& plugins,
                                const std::function<std::vector<BlockCheck>()>& compute) {
  const BuildKey build = this_build(plugins);
  StoredBlock out;
  out.file = folder / (build.sha256.substr(0, 16) + ".json");
  if (read_stored(build, out)) return out;
  const std::vector<BlockCheck> checks = compute();
  const std::string made = report_text(build, checks);
  try {
    StagedFile staged(out.file, made);
    // Another process may have been first: its report stays, since records name it.
    if (!staged.commit_as_first()) {
      if (read_stored(build, out)) return out;
      staged.commit();
    }
    out.kept = true;
  } catch (const RecordError&) {
    out.kept = false;
  }
  out.report = made;
  out.validity = summary_of(checks, made);
  return out;
}

std::filesystem::path validity_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "validity";
}

}  // namespace bb
