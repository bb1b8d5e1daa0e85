#include "experiments/run/stored_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"

namespace bb {
namespace {

std::vector<std::string> hashes(const std::vector<PluginFile>& plugins) {
  std::vector<std::string> out;
  out.reserve(plugins.size());
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

std::string build_of(const RunRecord& record) {
  return fmt::format("commit {} build {}", record.provenance.git_commit.substr(0, 8),
                     record.ids.build_id.substr(0, 8));
}

}  // namespace

std::optional<StoredRun> read_stored_run(const std::filesystem::path& file) {
  auto record = read_run(file);
  if (!record) return {};
  record->ids.config_id = config_id(record->config.text);
  return StoredRun{file, std::move(*record)};
}

std::optional<ConfigError> trace_fault(const StoredRun& stored) {
  const std::vector<Artifact>& files = stored.record.artifacts;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].kind != "trace") continue;
    const std::filesystem::path trace = stored.file.parent_path() / files[i].path;
    const std::string sha256 = sha256_file(trace.string());  // empty: not there
    if (sha256.empty() || sha256 == files[i].sha256) continue;
    return ConfigError(fmt::format("{}#/artifacts/{}/sha256", stored.file.string(), i),
                       fmt::format("\"{}\" with sha256 {}", trace.string(), sha256),
                       fmt::format("the trace that was written with the record, sha256 {}", files[i].sha256));
  }
  return {};
}

std::vector<Difference> differences(const RunRecord& then, const RunRecord& now) {
  const Provenance &made = then.provenance, &makes = now.provenance;
  std::vector<Difference> out;
  const auto compare = [&out](const char* what, const std::string& old_value, const std::string& new_value,
                              bool changes_state) {
    if (old_value == new_value) return;
    out.push_back({fmt::format("another {} ({}, not {})", what, new_value, old_value), changes_state});
  };
  compare("config", then.ids.config_id.substr(0, 8), now.ids.config_id.substr(0, 8), true);
  if (then.ids.build_id != now.ids.build_id) compare("build", build_of(then), build_of(now), true);
  if (hashes(made.plugins) != hashes(makes.plugins)) {
    compare("set of plugins", names(made.plugins), names(makes.plugins), true);
  }
  for (const auto& [name, version] : makes.libraries) {
    const auto found = made.libraries.find(name);
    compare(name == "blas" ? "BLAS or BLAS kernel" : name.c_str(),
            found == made.libraries.end() ? "unknown" : found->second, version, true);
  }
  compare("processor", then.machine.cpu_model, now.machine.cpu_model, true);
  compare("graphics card", then.machine.card.value_or("none"), now.machine.card.value_or("none"), true);
  if (then.machine.cpu_model == now.machine.cpu_model && then.machine.card == now.machine.card &&
      then.ids.machine_id != now.ids.machine_id) {
    out.push_back({"another machine (number of cores or kernel of the system)", false});
  }
  compare("number of threads", std::to_string(made.threads), std::to_string(makes.threads), false);
  return out;
}

bool was_cut(Outcome outcome) {
  return outcome == Outcome::timeout || outcome == Outcome::oom || outcome == Outcome::kernel_failed;
}

std::string why_run_again(const RunRecord& then, const RunRecord& now) {
  std::string out;
  for (const Difference& difference : differences(then, now)) {
    out += (out.empty() ? "" : "; ") + difference.what;
  }
  if (out.empty() && then.ids.run_id != now.ids.run_id) return "another run_id";
  const Outcome outcome = then.status.outcome;
  if (out.empty() && was_cut(outcome)) return "it ended as " + std::string(to_string(outcome));
  return out;
}

std::string why_run_again(const StoredRun& then, const RunRecord& now) {
  std::string why = why_run_again(then.record, now);
  if (!why.empty()) return why;
  if (const auto fault = trace_fault(then)) return fault->what();
  for (const Artifact& file : then.record.artifacts) {
    std::error_code unreachable;
    if (!std::filesystem::exists(then.file.parent_path() / file.path, unreachable))
      return file.path + " is gone";
  }
  return {};
}

}  // namespace bb
