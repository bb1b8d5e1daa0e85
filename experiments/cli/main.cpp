// The command line: parses flags, loads plugins, turns exceptions into exit codes. No other
// file prints errors.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "barriers/plugins.hpp"
#include "core/cudss/provide.hpp"
#include "core/math/error.hpp"
#include "core/parameters/registry.hpp"
#include "core/record/provenance.hpp"
#include "core/record/writer.hpp"
#include "experiments/cli/memory.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/run/device_run.hpp"

namespace {

using namespace bb::cli;

/// Nobody can read what was answered; an error that happened before stays what it is.
int unwritable_output(int code) {
  say("the standard output cannot be written\n");
  return code == exit_ok ? exit_try_again : code;
}

int guarded(const std::function<int()>& verb) {
  try {
    return verb();
  } catch (const bb::ConfigError& error) {
    say(fmt::format("{}\n", error.what()));
    return exit_bad_input;
  } catch (const bb::RecordError& error) {
    say(fmt::format("{}\n", error.what()));
    return error.lasting ? exit_bad_input : exit_try_again;
  } catch (const bb::Interrupted& stopped) {
    const std::string nothing = "no record was written; the same command runs it again";
    say(fmt::format("interrupted: {}\n", stopped.kept.empty() ? nothing : stopped.kept));
    return exit_try_again;
  } catch (const bb::DeviceStopped& stopped) {
    say(fmt::format("{}\n", stopped.what()));
    return stopped.outcome == bb::Outcome::oom ? exit_try_again : exit_internal;
  } catch (const bb::exec::OutOfMemory& error) {
    say(fmt::format("{}\n", error.what()));
    return exit_try_again;
  } catch (const std::bad_alloc&) {
    say("out of memory\n");
    return exit_try_again;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return unwritable_output(exit_ok);
    say(fmt::format("internal error: {}\n", error.what()));
    return exit_internal;
  }
}

/// A finite number from low (or above it) to high; CLI::Range lets NaN through.
CLI::Validator finite_number(double low, double high, bool above_low = false) {
  const std::string allowed =
      fmt::format("a number {} {:g}, at most {:g}", above_low ? "above" : "from", low, high);
  return {[=](const std::string& text) -> std::string {
            double value = 0;
            const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
            if (is_number && value <= high && (above_low ? value > low : value >= low)) return {};
            return fmt::format("found {}; allowed: {}", text, allowed);
          },
          allowed};
}

void config_arguments(CLI::App* app, RunVerb& verb) {
  app->add_option("config", verb.config, "a config file, e.g. configs/scenes/drape2d.json")->required();
  app->add_option("--set", verb.set, "override: /pointer=value, e.g. /time/dt_s=0.005")
      ->allow_extra_args(false);
}

/// Options that every verb takes, before the verb and after it, so that the help of each verb shows them.
void common_arguments(CLI::App& app, CommonOptions& common, std::vector<std::string>& plugins) {
  app.add_option(
         "--plugin", plugins,
         "a shared library (.so) with shapes, stiffness policies or integrators, loaded before anything "
         "is read; may be repeated (examples/plugins/README.md)")
      ->allow_extra_args(false);
  app.add_option(
         "--progress", common.progress,
         "auto (one line that is rewritten on a terminal, else a line every 30 s), plain (a line every 10 s) "
         "or none")
      ->check(CLI::IsMember({"auto", "plain", "none"}));
  app.add_option("--progress-every", common.progress_every_s, "seconds between two such lines")
      ->check(finite_number(0, 1e6, true));
  app.add_option("--blas-kernel", common.blas_kernel,
                 "haswell: the same factors on every x86-64-v3 machine (default, unless OPENBLAS_CORETYPE is "
                 "set); native: what OPENBLAS_CORETYPE names, else what OpenBLAS picks by the "
                 "processor")
      ->check(CLI::IsMember({"haswell", "native"}));
}

void limit_arguments(CLI::App* app, RunLimits& limits) {
  app->add_flag(
      "--resume", limits.resume,
      "go on from the checkpoint of a run that was stopped by a signal, its time limit or a lack of memory, "
      "or killed (/output/checkpoint_every); without one, from the start");
  app->add_option("--time-limit", limits.time_limit_s,
                  "seconds that one run may take: it ends between two steps with the outcome timeout, and "
                  "--resume goes on")
      ->check(finite_number(0, 1e9, true));
}

void demand_arguments(CLI::App* app, bb::ContactDemand& demand) {
  app->add_option("--contacts", demand.contacts,
                  "with a device: so many contacts are expected (default: estimated from the scene)")
      ->check(finite_number(0, 1e12));
  app->add_option("--blocks-per-contact", demand.upper_blocks_a_contact,
                  "stored 3x3 blocks on and above the diagonal that a contact has (default 0.49)")
      ->check(finite_number(0, 10));
  app->add_option("--candidates-per-contact", demand.candidates_a_contact,
                  "pairs of the broad phase that a contact has (default 2)")
      ->check(finite_number(0, 1e3));
}

CLI::App* add_matrix(CLI::App& app, MatrixVerb& verb) {
  CLI::App* out = app.add_subcommand(
      "matrix", "a stored system through every linear solver, preconditioner and condition estimator");
  out->add_option("files", verb.files, "Matrix Market files, each with its side-car NAME.json or without")
      ->required();
  out->add_option("--json", verb.json, "file of everything that the tables show");
  out->add_option("--tol", verb.tol_rel, "|b - A x| <= tol |b| of iterative solvers (default 1e-8)")
      ->check(finite_number(0, 1, true));
  out->add_option("--max-iterations", verb.max_iterations, "their cap (default 10000)")
      ->check(CLI::Range(1, 1000000000));
  out->add_option("--dense-rows", verb.dense_rows,
                  "up to so many rows (default 1500, at most 3000) all eigenvalues are computed too")
      ->check(CLI::Range(0, 3000));
  out->footer("example: ./bench matrix results/matrices/*.mtx --json replay.json");
  return out;
}

CLI::App* add_validity(CLI::App& app, ValidityVerb& verb) {
  CLI::App* out = app.add_subcommand(
      "validity",
      "checks of this build with known answers: solvers, estimators, derivatives, CCD, short runs");
  out->add_flag("--json", verb.json, "the report as JSON");
  out->footer(
      "Made by the first run of a build and kept beside the program; a build that fails shows no times.");
  return out;
}

CLI::App* add_device(CLI::App& app, DeviceVerb& verb) {
  CLI::App* out =
      app.add_subcommand("device", "the card that this build can use, or why there is none (exit 5)");
  out->add_flag("--json", verb.json, "as JSON");
  out->add_flag("--measure", verb.measure, "how fast copies are");
  out->footer("example: ./bench device --measure");
  return out;
}

CLI::App* add_ccd(CLI::App& app, CcdVerb& verb) {
  CLI::App* out = app.add_subcommand(
      "ccd", "queries with a known truth to both continuous tests: false negatives, false positives, times");
  out->add_option("folder", verb.folder,
                  "SCENE/vertex-face/*.csv and SCENE/edge-edge/*.csv, rational coordinates");
  out->add_option("--random", verb.random, "so many queries of each kind, their truth known by construction");
  out->add_option("--head-on", verb.head_on,
                  "so many sweeps of a point through a triangle for each gap and offset");
  out->add_option("--seed", verb.seed, "of both (default 1)");
  out->add_option("--json", verb.json, "file of everything that the table shows");
  out->footer("example: ./bench ccd --random 10000 --seed 1");
  return out;
}

/// The first word of the command line that is no option and no value of an option before the verb.
std::string first_word(const std::vector<std::string>& argv) {
  for (std::size_t i = 1; i < argv.size(); ++i) {
    if (argv[i] == "--plugin" || argv[i] == "--progress" || argv[i] == "--progress-every" ||
        argv[i] == "--blas-kernel") {
      ++i;
    } else if (!argv[i].starts_with("-")) {
      return argv[i];
    }
  }
  return "";
}

/// Errors: ConfigError with the nearest verb when the command line starts with a word that is none.
/// BENCH_VERBS: verbs of the script ./bench, which it handles itself.
void require_verb(const CLI::App& app, const std::vector<std::string>& argv) {
  const std::string word = first_word(argv);
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands(nullptr)) verbs.push_back(verb->get_name());
  if (word.empty() || std::find(verbs.begin(), verbs.end(), word) != verbs.end()) return;
  std::istringstream of_script(std::getenv("BENCH_VERBS") ? std::getenv("BENCH_VERBS") : "");
  for (std::string verb; of_script >> verb;) verbs.push_back(verb);
  throw bb::unknown_name("bench", word, verbs);
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

example: ./bench sweep configs/sweeps/demo_strip.json --dry-run)";

}  // namespace

bb::PluginFile bb::cli::load_plugin_file(const std::string& file) {
  const std::string name = bb::register_plugin(file).name;  // refuses what is no regular file
  return {name, file, bb::sha256_file(file)};
}

// NOLINTNEXTLINE(bugprone-exception-escape): outside guarded() only the parser's own tables are made
int main(int argc, char** argv) {
  prepare_streams();
  keep_freed_memory();
  bb::cudss::provide();
  CommonOptions common;
  common.argv.assign(argv, argv + argc);
  RunVerb run_verb, check_verb, explain_verb;
  bb::ContactDemand demand;
  SweepVerb sweep_verb;
  StepsVerb steps_verb;
  MatrixVerb matrix_verb;
  ValidityVerb validity_verb;
  CcdVerb ccd_verb;
  DeviceVerb device_verb;
  std::vector<std::string> plugins_before, plugins_after;  // the verb
  std::string list_what = "all", eval_file = "-", demo_out = "results/runs/demo";
  std::string help_format = "config";
  bool eval_schema = false, help_schema = false;

  CLI::App app{"barrierbench: contact barriers compared in one Newton + ACCD pipeline"};
  app.name("bench");
  app.require_subcommand(1);
  common_arguments(app, common, plugins_before);

  auto* run_app = app.add_subcommand("run", "one config, one record; a record (run.json) repeats itself");
  config_arguments(run_app, run_verb);
  run_app->add_option("--out", run_verb.out, "folder of run.json (default results/runs/<label>)");
  run_app->add_flag("--keep-inputs", run_verb.keep_inputs, "copy meshes and plugins beside the record");
  limit_arguments(run_app, run_verb.limits);
  run_app->footer("example: ./bench run configs/scenes/drape2d.json --set /formulation=\"cubic\"");
  auto* sweep_app =
      app.add_subcommand("sweep", "a base config and axes: one record a run, finished ones skipped");
  sweep_app->add_option("spec", sweep_verb.spec, "a sweep file, e.g. configs/sweeps/demo_strip.json")
      ->required();
  sweep_app->add_option("--set", sweep_verb.set, "override in every case")->allow_extra_args(false);
  sweep_app->add_option("--out", sweep_verb.out, "folder (default results/runs/<name>)");
  sweep_app->add_flag("--keep-inputs", sweep_verb.keep_inputs, "copy meshes and plugins beside each record");
  sweep_app->add_flag("--dry-run", sweep_verb.dry_run, "print what would run");
  sweep_app->add_flag("--again", sweep_verb.again, "run finished ones too");
  limit_arguments(sweep_app, sweep_verb.limits);
  sweep_app->footer(sweep_help);
  auto* steps_app = app.add_subcommand(
      "steps", "single steps of a run from one state, by every choice of Hessian: iterations and errors");
  steps_app->add_option("config", steps_verb.config, "a config file")->required();
  steps_app->add_option("--set", steps_verb.set, "override: /pointer=value")->allow_extra_args(false);
  steps_app->add_option("--at", steps_verb.at, "steps, from 0, ascending, with commas between")
      ->required()
      ->delimiter(',')
      ->allow_extra_args(false);
  steps_app->add_option("--out", steps_verb.out, "JSON file with every |dx|, for ./bench figures");
  steps_app->footer("example: ./bench steps configs/scenes/drape.json --at 11,21 --out steps.json");
  CLI::App* matrix_app = add_matrix(app, matrix_verb);
  CLI::App* validity_app = add_validity(app, validity_verb);
  CLI::App* ccd_app = add_ccd(app, ccd_verb);
  CLI::App* device_app = add_device(app, device_verb);
  auto* check_app = app.add_subcommand("check", "parse a config, build its scene, look for intersections");
  config_arguments(check_app, check_verb);
  check_app->footer("example: ./bench check configs/scenes/drape.json");
  auto* explain_app = app.add_subcommand("explain", "what a run would do, what it would skip, and why");
  config_arguments(explain_app, explain_verb);
  demand_arguments(explain_app, demand);
  explain_app->footer("example: ./bench explain configs/scenes/drape2d.json --set /time/dt_s=0.005");
  auto* list_app = app.add_subcommand("list", "what can be named in a config");
  list_app->add_option("what", list_what, fmt::format("which section: {}", fmt::join(list_sections(), ", ")));
  list_app->footer("example: ./bench list shapes");
  auto* help_app = app.add_subcommand(
      "help", "every setting or field of a file, from the lists that the program reads and writes it by");
  help_app->add_option("format", help_format, fmt::format("which file: {}", fmt::join(help_formats(), ", ")));
  help_app->add_flag("--schema", help_schema, "print the JSON Schema instead");
  help_app->footer("examples: ./bench help config, ./bench help record");
  auto* eval_app = app.add_subcommand("eval", "JSON Lines queries to the functions that the pipeline runs");
  eval_app->add_option("file", eval_file, "queries, - for standard input");
  eval_app->add_flag("--schema", eval_schema, "print the JSON Schema of all kinds");
  eval_app->footer(
      "example: echo '{\"kind\":\"shape\",\"shape\":\"log\",\"d\":0.5,\"d_hat\":1}' | ./bench eval");
  auto* demo_app = app.add_subcommand("demo", "the comparison of the README");
  demo_app->add_option("--out", demo_out, "folder of the records");
  demo_app->footer("example: ./bench demo");

  for (CLI::App* verb : app.get_subcommands(nullptr)) common_arguments(*verb, common, plugins_after);

  if (const int code = guarded([&] { return require_verb(app, common.argv), exit_ok; }); code != exit_ok) {
    return code;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream answer, complaint;
    const int code = app.exit(error, answer, complaint);
    say(complaint.str());
    std::fputs(answer.str().c_str(), stdout);
    const bool written = std::fflush(stdout) == 0;
    return code != 0 ? exit_bad_input : written ? exit_ok : unwritable_output(exit_ok);
  }
  // Nothing was read so far: this may start the program again.
  if (const int code = guarded([&] { return settle_blas_kernel(common.blas_kernel, common.argv), exit_ok; });
      code != exit_ok)
    return code;
  const int code = guarded([&]() -> int {
    common.plugins = plugins_before;
    common.plugins.insert(common.plugins.end(), plugins_after.begin(), plugins_after.end());
    for (const std::string& file : common.plugins) common.loaded.push_back(load_plugin_file(file));
    // The verbs that ask whether to stop; the others, and the loading of plugins, end at the signal itself.
    if (run_app->parsed() || sweep_app->parsed() || demo_app->parsed() || steps_app->parsed()) {
      install_interrupt();
    }
    if (run_app->parsed()) return run(run_verb, common);
    if (sweep_app->parsed()) return sweep(sweep_verb, common);
    if (steps_app->parsed()) return steps(steps_verb, common);
    if (matrix_app->parsed()) return matrix(matrix_verb, common);
    if (validity_app->parsed()) return validity(validity_verb, common);
    if (ccd_app->parsed()) return ccd(ccd_verb);
    if (device_app->parsed()) return device(device_verb);
    if (check_app->parsed()) return check(check_verb);
    if (explain_app->parsed()) return explain(explain_verb, demand);
    if (list_app->parsed()) return list(list_what);
    if (eval_app->parsed()) return eval(eval_file, eval_schema);
    if (help_app->parsed()) return help(help_format, help_schema);
    return demo(demo_out, common);
  });
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return unwritable_output(code);
}
