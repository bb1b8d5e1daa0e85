#include <fmt/format.h>

#include <filesystem>

#include "core/base/record/folder_lock.hpp"
#include "core/base/record/run_folder.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/summary_table.hpp"
#include "experiments/cli/terminal.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"

namespace bb::cli {

RunOptions run_options(const CommonOptions& common) {
  RunOptions options;
  options.argv = common.argv;
  options.plugins = common.loaded;
  options.interrupted = &interrupted();
  options.build = build_validity(common);
  return options;
}

RunRecord run_and_show(const RunConfig& config, RunOptions options, const CommonOptions& common) {
  ProgressLine line(common);
  options.progress = [&line](const Progress& progress) { line.show(progress); };
  options.tell = [&line](const std::string& text) { line.clear(), say(text + "\n"); };
  RunRecord record = run_config(config, options);
  line.clear();
  show("{}\n{}\n", summary_header(), summary_row(record));
  if (!record.status.detail.empty()) print_wrapped("  " + record.status.detail, 4);
  show("{}\n", (options.folder / "run.json").string());
  return record;
}

namespace {

/// The folder holds the record of this very run with all of its files, and no time limit and no lack of memory ended it.
bool is_over(const RunConfig& config, const RunOptions& options) {
  std::error_code unreachable;
  if (std::filesystem::exists(pending_record(options.folder), unreachable))
    return false;  // run_config ends it
  const auto stored = read_stored_run(options.folder / "run.json");
  if (!stored) return false;
  RunConfig chosen = config;
  decide_linear_solver(chosen);
  return why_run_again(*stored, identified(chosen, options)).empty();
}

/// A config, or a record: rerun().
int run(const RunVerb& verb, const CommonOptions& common) {
  if (const auto stored = read_stored_run(verb.config)) return rerun(*stored, verb, common);
  const RunConfig config = load_run(verb.config, verb.set);
  RunOptions options = run_options(common);
  options.folder = verb.out.empty() ? "results/runs/" + run_label(config) : verb.out;
  options.keep_inputs = verb.keep_inputs;
  options.replace = verb.replace ? Replace::all : Replace::own;
  options.resume = verb.limits.resume ? Resume::yes : Resume::no;
  verb.limits.put_in(options);
  if (verb.limits.resume && is_over(config, options)) {
    remove_dead_lock(options.folder);  // of a process that was killed with its record in place
    show("already there\n{}\n", (options.folder / "run.json").string());
    return exit_ok;
  }
  run_and_show(config, options, common);
  return exit_ok;
}

}  // namespace

Action verb::run(CLI::App& app) {
  const auto verb = std::make_shared<RunVerb>();
  config_arguments(app, *verb);
  app.add_option("--out", verb->out, "folder of run.json (default results/runs/<label>)");
  app.add_flag("--replace", verb->replace,
               "a record, a checkpoint, or another file of their names in that folder goes, with the files "
               "of the record; "
               "without it, those of the same config alone");
  app.add_flag("--keep-inputs", verb->keep_inputs, "copy meshes, films and plugins beside the record");
  limit_arguments(app, verb->limits);
  return [verb](const CommonOptions& common) { return install_interrupt(), cli::run(*verb, common); };
}

}  // namespace bb::cli
