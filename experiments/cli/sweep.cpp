#include <fmt/format.h>

#include <filesystem>

#include "core/math/error.hpp"
#include "core/record/folder_lock.hpp"
#include "core/record/run_folder.hpp"
#include "core/record/writer.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/sweep_spec.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/comparability.hpp"

namespace bb::cli {
namespace {

std::string folder_name(const SweepCase& one) {
  std::string name;
  for (const char c : one.label) name += c == ' ' || c == '/' ? '_' : c;
  return name + "-" + config_id(one.config).substr(0, 8);
}

/// What every case of one sweep shares.
struct Sweep {
  const SweepVerb& verb;
  const CommonOptions& common;
  SweepSpec spec;
  std::filesystem::path out;
  std::vector<bool> refused;  // one a case
  int kept = 0;               // records that are there, of spec.cases.size()
};

RunOptions case_options(const Sweep& sweep, const SweepCase& one) {
  RunOptions options = run_options(sweep.common);
  options.folder = sweep.out / folder_name(one);
  options.note = sweep.spec.name + ": " + one.label;
  options.sweep_id = sweep.spec.name;
  options.swept = one.swept;
  options.keep_inputs = sweep.verb.keep_inputs;
  options.resume = sweep.verb.limits.resume ? Resume::yes
                   : sweep.verb.again       ? Resume::no
                                            : Resume::if_this_run;
  options.time_limit_s = sweep.verb.limits.time_limit_s;
  return options;
}

/// True when the record of this very run is there: run_id, config, program, plugins, libraries, machine. A
/// record of another run, or one that cannot be read, is named and gives way.
bool already_there(const Sweep& sweep, const SweepCase& one, const RunOptions& options) {
  const std::filesystem::path file = options.folder / "run.json";
  std::error_code unreachable;
  if (sweep.verb.again || !std::filesystem::exists(file, unreachable)) return false;
  if (std::filesystem::exists(pending_record(options.folder), unreachable))
    return false;  // run_config ends it
  const RunRecord now = identified(one.config, options);
  std::string why = "its run.json cannot be read";
  try {
    const auto stored = read_stored_run(file);
    if (stored) why = why_run_again(stored->record, now);
    if (const auto fault = stored && why.empty() ? trace_fault(*stored) : std::nullopt) why = fault->what();
    if (why.empty()) return true;
  } catch (const ConfigError& error) {
    why = error.what();
  }
  fmt::print("{:<44} runs again: {}\n", options.note, why);
  return false;
}

void run_case(const SweepCase& one, RunOptions options, ProgressLine& line) {
  options.progress = [&line](const Progress& progress) { line.show(progress); };
  options.tell = [&line](const std::string& text) { line.clear(), say(text + "\n"); };
  const RunRecord record = run_config(one.config, options);
  line.clear();
  fmt::print("{}\n", summary_row(record));
  if (record.status.outcome != Outcome::ok) fmt::print("  {}\n", record.status.detail);
  std::fflush(stdout);
}

/// Runs every case that can be run; returns what is wrong with the others.
std::vector<Violation> run_cases(Sweep& sweep) {
  ProgressLine line(sweep.common);
  std::vector<Violation> violations;  // a case that cannot be run stops no other
  for (std::size_t i = 0; i < sweep.spec.cases.size(); ++i) {
    const SweepCase& one = sweep.spec.cases[i];
    const RunOptions options = case_options(sweep, one);
    line.begin(fmt::format("[{}/{}] ", i + 1, sweep.spec.cases.size()));
    try {
      if (already_there(sweep, one, options)) {
        fmt::print("{:<44} already there\n", options.note);
      } else {
        run_case(one, options, line);
      }
      ++sweep.kept;
    } catch (const EarlierStays& stays) {
      line.clear();
      fmt::print("{:<44} {}\n", options.note, stays.kept);
      ++sweep.kept;
    } catch (const ConfigError& error) {
      line.clear();
      sweep.refused[i] = true;
      std::error_code unreachable;
      const bool earlier = std::filesystem::exists(options.folder / "run.json", unreachable);
      fmt::print("{:<44} no record{}\n", options.note, earlier ? "; the one of an earlier sweep stays" : "");
      for (Violation v : error.violations()) {
        v.where = sweep.verb.spec + " [" + one.label + "] " + v.where;
        violations.push_back(std::move(v));
      }
    }
  }
  return violations;
}

/// Which runs may be compared, in every record of the sweep, those that were already there among them.
void compare_cases(const Sweep& sweep) {
  std::vector<SweepMember> members;
  for (std::size_t i = 0; i < sweep.spec.cases.size(); ++i) {
    const SweepCase& one = sweep.spec.cases[i];
    members.push_back({sweep.out / folder_name(one), one.reference, one.group, !sweep.refused[i]});
  }
  write_comparability(members);
}

/// A line for every case that is in: its outcome, and whether its numbers may be compared with the others.
void print_comparability(const Sweep& sweep) {
  fmt::print("\n{:<44} {:<18} {:<15} {}\n", "run", "outcome", "comparability", "why");
  for (std::size_t i = 0; i < sweep.spec.cases.size(); ++i) {
    const SweepCase& one = sweep.spec.cases[i];
    if (sweep.refused[i]) continue;
    const auto record = read_run(sweep.out / folder_name(one) / "run.json");
    if (!record) continue;
    fmt::print("{:<44} {:<18} {:<15} {}\n", sweep.spec.name + ": " + one.label,
               to_string(record->status.outcome), record->comparability.verdict,
               record->comparability.verdict == "comparable" ? "" : record->comparability.reason);
  }
  std::fflush(stdout);
}

constexpr const char* sweep_help =
    R"(A sweep file is JSON (schema: configs/schema/sweep.schema.json), for example:
{
  "schema": "barrierbench.sweep/1",
  "name": "my_sweep",
  "base": "../scenes/drape.json",
  "set": {"/time/steps": 12},
  "axes": [
    {"pointer": "/time/dt_s", "values": [0.01, 0.005]},
    {"cases": [{"label": "log", "set": {"/formulation": "log"}},
               {"label": "cubic", "set": {"/formulation": "cubic"}}]}
  ]
}

name: the folder results/runs/my_sweep. base: a config, relative to this file. set: overrides of every case.
An axis is either {pointer, values}, one setting with one case for each value, or {cases}, named cases that
each set several. With more than one axis every combination is run: here 2 x 2 = 4 records.

)";

}  // namespace

int sweep(const SweepVerb& verb, const CommonOptions& common) {
  Sweep sweep{verb, common, load_sweep(verb.spec, verb.set), {}, {}};
  sweep.refused.resize(sweep.spec.cases.size());
  sweep.out = verb.out.empty() ? std::filesystem::path("results/runs") / sweep.spec.name
                               : std::filesystem::path(verb.out);
  if (verb.dry_run) {
    for (const SweepCase& one : sweep.spec.cases) {
      fmt::print("{}\n", (sweep.out / folder_name(one)).string());
    }
    return exit_ok;
  }
  const FolderLock lock(sweep.out);
  remove_unfinished(sweep.out);
  write_atomically(sweep.out / "sweep.json", sweep.spec.text);
  fmt::print("{}\n", summary_header());
  std::fflush(stdout);
  std::vector<Violation> violations;
  try {
    violations = run_cases(sweep);
  } catch (const Interrupted&) {
    throw Interrupted{fmt::format(
        "{} of {} records kept in {}; the same command runs the rest, and goes on from the checkpoint of "
        "the one that was stopped",
        sweep.kept, sweep.spec.cases.size(), sweep.out.string())};
  }
  compare_cases(sweep);
  print_comparability(sweep);
  if (!violations.empty()) throw ConfigError(violations);
  return exit_ok;
}

Action verb::sweep(CLI::App& app) {
  const auto verb = std::make_shared<SweepVerb>();
  app.add_option("spec", verb->spec, "a sweep file, e.g. configs/sweeps/demo_strip.json")->required();
  set_argument(app, verb->set, "override in every case");
  app.add_option("--out", verb->out, "folder (default results/runs/<name>)");
  app.add_flag("--keep-inputs", verb->keep_inputs, "copy meshes and plugins beside each record");
  app.add_flag("--dry-run", verb->dry_run, "print what would run");
  app.add_flag("--again", verb->again, "run finished ones too");
  limit_arguments(app, verb->limits);
  app.footer(sweep_help + app.get_footer());
  return [verb](const CommonOptions& common) { return install_interrupt(), cli::sweep(*verb, common); };
}

}  // namespace bb::cli
