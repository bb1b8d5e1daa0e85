#include "experiments/cli/sweep_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/input/read_file.hpp"
#include "core/base/record/folder_lock.hpp"
#include "core/base/record/run_folder.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/summary_table.hpp"
#include "experiments/cli/terminal.hpp"
#include "experiments/run/comparability.hpp"

namespace bb::cli {
namespace {

namespace fs = std::filesystem;

constexpr double lock_wait_s = 60;  // another process writes the same files, or judges

/// i and N of "i/N". Errors: ConfigError.
std::pair<std::size_t, std::size_t> read_shard(const std::string& text) {
  std::size_t i = 0, n = 0;
  char behind = 0;
  const bool read =
      std::sscanf(text.c_str(), "%zu/%zu%c", &i, &n, &behind) == 2 && text.find('-') == std::string::npos;
  if (read && i >= 1 && i <= n) return {i, n};
  throw ConfigError("--shard", '"' + text + '"', "i/N with 1 <= i <= N, such as 1/4");
}

/// Every Nth case in the order of the ids, which has nothing to do with the order of the axes: shards are of one size, and
/// none gets all runs of one formulation.
std::vector<std::size_t> shard_of(const SweepSpec& spec, std::size_t i, std::size_t n) {
  std::vector<std::size_t> order(spec.cases.size()), out;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return spec.cases[a].config_id < spec.cases[b].config_id;
  });
  for (std::size_t k = i - 1; k < order.size(); k += n) out.push_back(order[k]);
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<std::size_t> chosen_cases(const SweepVerb& verb, const SweepSpec& spec) {
  if (verb.index) {
    if (*verb.index < spec.cases.size()) return {*verb.index};
    throw ConfigError(
        "--index", std::to_string(*verb.index),
        fmt::format("0 to {}: {} has {} cases", spec.cases.size() - 1, verb.spec, spec.cases.size()));
  }
  if (!verb.shard.empty()) {
    const auto [i, n] = read_shard(verb.shard);
    return shard_of(spec, i, n);
  }
  std::vector<std::size_t> all(spec.cases.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::string cases_text(const SweepSpec& spec) {
  nlohmann::ordered_json out = {{"schema", "barrierbench.cases/1"}, {"sweep", spec.name}};
  nlohmann::ordered_json& cases = out["cases"] = nlohmann::ordered_json::array();
  for (const SweepCase& one : spec.cases) {
    cases.push_back({{"folder", folder_name(one)},
                     {"label", one.label},
                     {"config_id", one.config_id},
                     {"swept", one.swept}});
  }
  return out.dump(1) + "\n";
}

void write_changed(const fs::path& file, const std::string& text) {
  std::ifstream in(file, std::ios::binary);
  if (std::string(std::istreambuf_iterator<char>(in), {}) != text) write_atomically(file, text);
}

}  // namespace

std::string folder_name(const SweepCase& one) {
  std::string name;
  for (const char c : one.label) name += c == ' ' || c == '/' ? '_' : c;
  return name + "-" + one.config_id.substr(0, 8);
}

Sweep open_sweep(const SweepVerb& verb, const CommonOptions& common, const SeenCase& seen) {
  if (verb.index && (!verb.shard.empty() || verb.jobs > 1)) {
    throw ConfigError("--index", verb.shard.empty() ? "--jobs beside it" : "--shard beside it",
                      "one of them: an index is one run");
  }
  if (!verb.shard.empty()) read_shard(verb.shard);
  Sweep sweep{verb, common, load_sweep(verb.spec, verb.set, verb.index, seen), {}, {}, {}};
  sweep.chosen = chosen_cases(verb, sweep.spec);
  sweep.out = verb.out.empty() ? fs::path("results/runs") / sweep.spec.name : fs::path(verb.out);
  if (sweep.verb.limits.time_limit_s == 0) sweep.verb.limits.time_limit_s = sweep.spec.budget.run_s;
  return sweep;
}

RunOptions case_options(const Sweep& sweep, std::size_t i) {
  RunOptions options = sweep.options;
  options.folder = sweep.folder(i);
  options.note = sweep.note(i);
  options.sweep_id = sweep.spec.name;
  options.swept = sweep.spec.cases[i].swept;
  options.keep_inputs = sweep.verb.keep_inputs;
  options.replace = Replace::torn;
  options.resume = sweep.verb.limits.resume ? Resume::yes
                   : sweep.verb.again       ? Resume::no
                                            : Resume::if_this_run;
  sweep.verb.limits.put_in(options);
  return options;
}

std::string why_to_run(const Sweep& sweep, std::size_t i, const RunConfig& config) {
  const fs::path folder = sweep.folder(i), file = folder / "run.json";
  std::error_code unreachable;
  if (sweep.verb.again || !fs::exists(file, unreachable)) return "nothing";
  if (fs::exists(pending_record(folder), unreachable)) return "nothing";  // run_config ends it
  try {
    const auto stored = read_stored_run(file);
    if (!stored) return "its run.json cannot be read";
    return why_run_again(*stored, identified(config, case_options(sweep, i)));
  } catch (const ConfigError& error) {
    return error.what();
  }
}

double core_seconds(const RunRecord& record) {
  const Summary& s = record.summary;
  const auto started = seconds_of_utc(record.status.started_utc),
             ended = seconds_of_utc(record.status.ended_utc);
  const bool resumed =
      record.status.resumed_from_step.finite();  // the time between two processes is no time of the run
  double wall = started && ended && !resumed ? *ended - *started : 0;
  if (resumed && s.wall_s.finite()) wall = s.wall_s.value;
  return wall * std::max(1, record.provenance.threads);
}

void write_sweep_files(const Sweep& sweep) {
  const FolderLock lock(sweep.out, lock_wait_s);
  remove_unfinished(sweep.out);
  write_changed(sweep.out / "sweep.json", sweep.spec.text);
  if (!sweep.verb.index) write_changed(sweep.out / "cases.json", cases_text(sweep.spec));
}

bool all_there(const Sweep& sweep) {
  std::error_code unreachable;
  for (std::size_t i = 0; i < sweep.spec.cases.size(); ++i) {
    if (!fs::exists(sweep.folder(i) / "run.json", unreachable)) return false;
  }
  return true;
}

void compare_cases(const Sweep& sweep, const std::vector<bool>& refused) {
  const FolderLock lock(sweep.out, lock_wait_s);
  std::vector<SweepMember> members;
  for (std::size_t i = 0; i < sweep.spec.cases.size(); ++i) {
    const SweepCase& one = sweep.spec.cases[i];
    members.push_back({sweep.folder(i), one.reference, one.group, !refused[i]});
  }
  write_comparability(members);
  std::vector<ComparedRow> rows;
  for (std::size_t i = 0; i < sweep.spec.cases.size(); ++i) {
    if (refused[i]) continue;
    const auto record = read_run(sweep.folder(i) / "run.json");
    if (!record) continue;
    const Comparability& judged = record->comparability;
    rows.push_back({sweep.note(i), std::string(to_string(record->status.outcome)), judged.verdict,
                    judged.verdict == "comparable" ? "" : judged.reason});
  }
  show("\n{}", comparability_table(std::move(rows), terminal_columns(STDOUT_FILENO)));
  std::fflush(stdout);
}

}  // namespace bb::cli
