#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/base/record/folder_lock.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/summary_table.hpp"
#include "experiments/cli/sweep_run.hpp"

namespace bb::cli {
namespace {

constexpr const char* sweep_help =
    R"(A sweep file is JSON (schema: configs/schema/sweep.schema.json), for example:
{
  "schema": "barrierbench.sweep/1",
  "name": "my_sweep",
  "base": "configs/scenes/drape.json",
  "set": {"/time/steps": 12},
  "axes": [
    {"pointer": "/time/dt_s", "values": [0.01, 0.005]},
    {"cases": [{"label": "log", "set": {"/formulation": "log"}},
               {"label": "cubic", "set": {"/formulation": "cubic"}}]}
  ]
}

name: the folder results/runs/my_sweep. base: a config, relative to this file. set: overrides of every case.
An axis is either {pointer, values}, one setting with one case for each value, or {cases}, named cases that
each set several. With more than one axis every combination is run: here 2 x 2 = 4 records. Also:
  {"pointer": P, "range": {"from": 0.001, "to": 0.1, "count": 3, "scale": "log"}}   numbers between two ends
  {"zip": [AXIS, AXIS]}                           axes of one length that go along with one another
  "exclude": [{"where": {P: VALUE}, "labels": [L]}]         leaves out what has all of it
  "repeat": 3, "seed": 7                          three runs of each case, with seeds that formulations share
  "budget": {"core_s": 3600, "run_s": 60}         no run begins beyond it; a run ends as timeout

./bench plan FILE shows the cases, their numbers for --index, and what they are expected to take.
Several calls may work in one folder at the same time: no run is made twice. Exit code 75: call it again.

)";

/// Runs that other processes are at.
RecordError in_use_text(const Sweep& sweep, const SweepTally& tally) {
  const auto first = sweep.folder(tally.in_use.front());
  return {fmt::format("{} of {} {}, the first in {}: in use by {}; try again when they have ended",
                      tally.in_use.size(), sweep.chosen.size(), made_by_others, first.string(),
                      lock_holder(first)),
          false};
}

/// The exit code, or the error that says it: wrong input before what failed, that before what may be tried again.
int ended_as(const Sweep& sweep, const SweepTally& tally) {
  if (tally.beyond_budget > 0) {
    show("{} of {} runs were not begun: the budget of {:g} core s is spent\n", tally.beyond_budget,
         sweep.chosen.size(), sweep.spec.budget.core_s);
  }
  say(tally.complaints);
  if (!tally.violations.empty()) throw ConfigError(tally.violations);
  if (std::find(tally.refused.begin(), tally.refused.end(), true) != tally.refused.end())
    return exit_bad_input;
  if (tally.failed) return exit_internal;
  if (tally.try_again) return exit_try_again;
  if (!tally.in_use.empty()) throw in_use_text(sweep, tally);
  return exit_ok;
}

}  // namespace

int sweep(const SweepVerb& verb, const CommonOptions& common) {
  Sweep sweep = open_sweep(verb, common);
  if (verb.dry_run) {
    for (const std::size_t i : sweep.chosen) show("{}\n", sweep.folder(i).string());
    return exit_ok;
  }
  sweep.options = run_options(common);
  write_sweep_files(sweep);
  show("{}\n", summary_header());
  std::fflush(stdout);
  const SweepTally tally = run_sweep_cases(sweep);
  const bool is_over = tally.in_use.empty() && !tally.try_again && !tally.failed && tally.beyond_budget == 0;
  // a share judges when it ends last, a single run never: that would read all records each time
  if (is_over && !verb.index && (sweep.whole() || all_there(sweep))) compare_cases(sweep, tally.refused);
  return ended_as(sweep, tally);
}

Action verb::sweep(CLI::App& app) {
  const auto verb = std::make_shared<SweepVerb>();
  app.add_option("spec", verb->spec, "a sweep file, e.g. configs/sweeps/demo_strip.json")->required();
  set_argument(app, verb->set, "override in every case");
  app.add_option("--out", verb->out, "folder (default results/runs/<name>)");
  app.add_option("--jobs", verb->jobs,
                 "runs at a time, each in a process of its own (default 1, in this process)")
      ->check(CLI::Range(1, 4096));
  app.add_option("--shard", verb->shard, "i/N: the i-th of N shares of one size, 1 to N");
  app.add_option("--index", verb->index, "one case by its number in ./bench plan, from 0");
  app.add_flag("--keep-inputs", verb->keep_inputs, "copy meshes, films and plugins beside each record");
  app.add_flag("--dry-run", verb->dry_run, "print what would run");
  app.add_flag("--again", verb->again, "run finished ones too");
  limit_arguments(app, verb->limits);
  app.footer(sweep_help + app.get_footer());
  return [verb](const CommonOptions& common) { return install_interrupt(), cli::sweep(*verb, common); };
}

}  // namespace bb::cli
