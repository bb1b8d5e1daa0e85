// `run RUN.json`: a record repeats itself and says whether the final state is the same, bit for bit.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "barriers/formulas.hpp"
#include "barriers/plugins.hpp"
#include "core/base/record/provenance.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"

namespace bb::cli {
namespace {

namespace fs = std::filesystem;

/// The folder from which the record names its files: without symbolic links, as the writer makes names.
fs::path home_of(const StoredRun& stored) {
  return fs::weakly_canonical(fs::absolute(stored.file)).parent_path();
}

/// The plugins of the record that no --plugin replaces, from where the record reports that they are.
/// Errors: ConfigError: not there, or another content.
void load_plugins(const StoredRun& stored, std::vector<PluginFile>& loaded) {
  for (std::size_t i = 0; i < stored.record.provenance.plugins.size(); ++i) {
    const PluginFile& wanted = stored.record.provenance.plugins[i];
    const bool given = std::any_of(loaded.begin(), loaded.end(), [&wanted](const PluginFile& p) {
      return p.sha256 == wanted.sha256 || p.name == wanted.name;
    });
    if (given || is_formula(wanted.name)) continue;  // the config has the formula itself
    const fs::path file = (home_of(stored) / wanted.file).lexically_normal();
    const std::string where = fmt::format("{}#/provenance/plugins/{}", stored.file.string(), i);
    const std::string sha256 = sha256_file(file.string());  // empty: not there, or no regular file
    const std::string allowed =
        fmt::format("the plugin \"{}\" with sha256 {} there, or another of this name with --plugin",
                    wanted.name, wanted.sha256);
    if (sha256.empty())
      throw ConfigError(where + "/file", fmt::format("no file \"{}\"", file.string()), allowed);
    if (sha256 != wanted.sha256) {
      throw ConfigError(where + "/sha256", fmt::format("\"{}\" with sha256 {}", file.string(), sha256),
                        allowed);
    }
    loaded.push_back(load_plugin_file(file.string()));
  }
}

/// results/runs/LABEL-rerun, with a number when that is taken.
fs::path fresh_folder(const std::string& label) {
  const fs::path first = fs::path("results/runs") / (label + "-rerun");
  fs::path folder = first;
  std::error_code unreachable;
  for (int n = 2; fs::exists(folder, unreachable); ++n) folder = first.string() + "-" + std::to_string(n);
  return folder;
}

/// Prints the verdict; exit_no_repeat when nothing explains that the two differ.
int compare(const StoredRun& stored, const RunRecord& record) {
  const Outcome outcome = record.status.outcome, then = stored.record.status.outcome;
  const std::string& hash = stored.record.summary.state_hash;
  const bool same_state = record.summary.state_hash == hash;
  const bool same = same_state && outcome == then;
  std::string reasons;
  for (const Difference& difference : differences(stored.record, record)) {
    if (difference.changes_state) reasons += (reasons.empty() ? "" : "; ") + difference.what;
  }
  std::string verdict = hash.empty() && same_state ? "as before there is no first step and no final state"
                        : same_state ? fmt::format("the final state is the same, bit for bit (state_hash {})",
                                                   hash.substr(0, 8))
                                     : "the final state differs";
  if (outcome != then)
    verdict += fmt::format("; the outcome was {} and is {}", to_string(then), to_string(outcome));
  if (!same && reasons.empty()) verdict += ", and nothing that the records name explains it";
  if (!same && !reasons.empty()) verdict += ", as it may: " + reasons;
  if (same && !reasons.empty()) verdict += ", although it need not be: " + reasons;
  show("rerun of {}: {}\n", stored.file.string(), verdict);
  return same || !reasons.empty() ? exit_ok : exit_no_repeat;
}

}  // namespace

int rerun(const StoredRun& stored, const RunVerb& verb, const CommonOptions& common) {
  if (verb.limits.resume) {
    throw ConfigError("--resume", "a record, whose run is over", "the config of a run that was stopped");
  }
  const fs::path home = home_of(stored);
  std::error_code none_there;
  if (!verb.out.empty() && fs::equivalent(verb.out, home, none_there)) {
    throw ConfigError("--out", fmt::format("\"{}\", the folder of the record itself", verb.out),
                      "another folder: a rerun is compared with its record");
  }
  if (const auto fault = trace_fault(stored)) throw *fault;
  RunOptions options = run_options(common);
  load_plugins(stored, options.plugins);
  RunConfig config =
      parse_config(stored.record.config.text, stored.file.string() + " (config)", home.string(), verb.set);
  decide_linear_solver(config);
  options.folder = verb.out.empty() ? fresh_folder(run_label(config)) : fs::path(verb.out);
  options.keep_inputs = verb.keep_inputs;
  options.replace = verb.replace ? Replace::all : Replace::own;
  verb.limits.put_in(options);
  options.note = stored.record.labels.note;
  options.rerun_of = stored.record.ids.run_id;
  return compare(stored, run_and_show(config, options, common));
}

}  // namespace bb::cli
