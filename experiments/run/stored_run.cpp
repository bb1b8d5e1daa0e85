#include "experiments/run/stored_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/input/json.hpp"
#include "core/math/error.hpp"
#include "core/record/provenance.hpp"

namespace bb {
namespace {

using nlohmann::json;

StoredRun read_fields(const std::filesystem::path& file, const json& record) {
  const json &ids = record.at("ids"), &made = record.at("provenance"), &labels = record.at("labels");
  StoredRun run;
  run.file = file;
  run.config_json = record.at("config").dump();
  run.config_id = config_id(run.config_json);
  run.run_id = ids.at("run_id").get<std::string>();
  run.build_id = ids.at("build_id").get<std::string>();
  run.machine_id = ids.at("machine_id").get<std::string>();
  run.git_commit = made.at("git_commit").get<std::string>();
  run.threads = made.at("threads").get<int>();
  run.libraries = made.at("libraries").get<std::map<std::string, std::string>>();
  run.cpu_model = record.at("machine").at("cpu_model").get<std::string>();
  run.note = labels.at("note").get<std::string>();
  run.outcome = record.at("status").at("outcome").get<std::string>();
  run.state_hash = record.at("summary").at("state_hash").get<std::string>();
  for (const json& p : made.value("plugins", json::array())) {
    run.plugins.push_back({p.at("name").get<std::string>(), p.at("file").get<std::string>(),
                           p.at("sha256").get<std::string>()});
  }
  return run;
}

std::vector<std::string> hashes(const std::vector<PluginFile>& plugins) {
  std::vector<std::string> out;
  for (const PluginFile& plugin : plugins) out.push_back(plugin.sha256);
  std::sort(out.begin(), out.end());
  return out;
}

std::string names(const std::vector<PluginFile>& plugins) {
  std::string out;
  for (const PluginFile& p : plugins) {
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", p.name, p.sha256.substr(0, 8));
  }
  return out.empty() ? "none" : out;
}

}  // namespace

std::optional<StoredRun> read_stored_run(const std::filesystem::path& file) {
  try {
    const json record =
        parse_json(read_input_file(file.string(), record_file), file.string(), LargeIntegers::rounded);
    if (!record.is_object() || !record.contains("schema") || !record["schema"].is_object()) return {};
    if (record["schema"].value("name", json()) != "barrierbench.run") return {};
    return read_fields(file, record);
  } catch (const ConfigError&) {
    return {};
  } catch (const json::exception&) {
    return {};
  }
}

std::vector<Difference> differences(const StoredRun& then, const RunRecord& now) {
  std::vector<Difference> out;
  const auto compare = [&out](const char* what, const std::string& old_value, const std::string& new_value,
                              bool changes_state) {
    if (old_value == new_value) return;
    out.push_back({fmt::format("another {} ({}, not {})", what, new_value, old_value), changes_state});
  };
  compare("config", then.config_id.substr(0, 8), now.ids.config_id.substr(0, 8), true);
  if (then.build_id != now.ids.build_id) {
    compare("build",
            fmt::format("commit {} build {}", then.git_commit.substr(0, 8), then.build_id.substr(0, 8)),
            fmt::format("commit {} build {}", now.provenance.git_commit.substr(0, 8),
                        now.ids.build_id.substr(0, 8)),
            true);
  }
  if (hashes(then.plugins) != hashes(now.provenance.plugins)) {
    compare("set of plugins", names(then.plugins), names(now.provenance.plugins), true);
  }
  for (const auto& [name, version] : now.provenance.libraries) {
    const auto found = then.libraries.find(name);
    compare(name == "blas" ? "BLAS or BLAS kernel" : name.c_str(),
            found == then.libraries.end() ? "unknown" : found->second, version, true);
  }
  compare("processor", then.cpu_model, now.machine.cpu_model, true);
  if (then.cpu_model == now.machine.cpu_model && then.machine_id != now.ids.machine_id) {
    out.push_back({"another machine (number of cores or kernel of the system)", false});
  }
  compare("number of threads", std::to_string(then.threads), std::to_string(now.provenance.threads), false);
  return out;
}

}  // namespace bb
