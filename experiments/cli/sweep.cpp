#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "core/math/error.hpp"
#include "core/record/writer.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/sweep_spec.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/comparability.hpp"

namespace bb::cli {
namespace {

std::string folder_name(const SweepCase& one) {
  std::string name;
  for (const char c : one.label) name += c == ' ' || c == '/' ? '_' : c;
  return name + "-" + config_id(one.config).substr(0, 8);
}

void run_case(const SweepSpec& spec, const SweepCase& one, const std::filesystem::path& folder,
              const CommonOptions& common, ProgressLine& line) {
  RunOptions options;
  options.folder = folder;
  options.argv = common.argv;
  options.note = spec.name + ": " + one.label;
  options.sweep_id = spec.name;
  options.progress = [&line](const Progress& progress) { line.show(progress); };
  options.interrupted = &interrupted();
  const RunRecord record = run_config(one.config, options);
  line.clear();
  fmt::print("{}\n", summary_row(record));
  if (record.status.outcome != Outcome::ok) fmt::print("  {}\n", record.status.detail);
  std::fflush(stdout);
}

/// Which runs may be compared, in every record of the sweep, those that were already there among them.
void compare_cases(const SweepSpec& spec, const std::filesystem::path& out) {
  std::vector<SweepMember> members;
  for (const SweepCase& one : spec.cases) members.push_back({out / folder_name(one), one.reference});
  write_comparability(members);
}

/// An earlier run's, which `--again` did not replace.
void remove_record(const std::filesystem::path& folder) {
  std::error_code none_there;
  for (const char* name : {"run.json", "trace.jsonl"}) std::filesystem::remove(folder / name, none_there);
}

}  // namespace

int sweep(const SweepVerb& verb, const CommonOptions& common) {
  const SweepSpec spec = load_sweep(verb.spec, verb.set);
  const std::filesystem::path out =
      verb.out.empty() ? std::filesystem::path("results/runs") / spec.name : std::filesystem::path(verb.out);
  if (verb.dry_run) {
    for (const SweepCase& one : spec.cases) fmt::print("{}\n", (out / folder_name(one)).string());
    return exit_ok;
  }
  write_atomically(out / "sweep.json", spec.text);
  ProgressLine line(common.progress);
  fmt::print("{}\n", summary_header());
  std::fflush(stdout);
  std::vector<Violation> violations;  // a case that cannot be run keeps nobody else from running
  for (const SweepCase& one : spec.cases) {
    const std::filesystem::path folder = out / folder_name(one);
    if (!verb.again && std::filesystem::exists(folder / "run.json")) {
      fmt::print("{:<44} already there\n", spec.name + ": " + one.label);
      continue;
    }
    try {
      run_case(spec, one, folder, common, line);
    } catch (const ConfigError& error) {
      line.clear();
      remove_record(folder);
      fmt::print("{:<44} no record\n", spec.name + ": " + one.label);
      for (Violation v : error.violations()) {
        v.where = verb.spec + " [" + one.label + "] " + v.where;
        violations.push_back(std::move(v));
      }
    }
  }
  compare_cases(spec, out);
  if (!violations.empty()) throw ConfigError(violations);
  return exit_ok;
}

int demo(const std::string& out, const CommonOptions& common) {
  const std::filesystem::path specs = std::filesystem::path(configs_folder()) / "sweeps";
  for (const char* name : {"demo_strip", "demo_pinned", "demo_article", "demo_drape"}) {
    SweepVerb verb;
    verb.spec = (specs / (std::string(name) + ".json")).string();
    verb.out = (std::filesystem::path(out) / name).string();
    if (const int code = sweep(verb, common); code != exit_ok) return code;
    fmt::print("\n");
  }
  return exit_ok;
}

}  // namespace bb::cli
