// The command line: parses flags, loads plugins, turns exceptions into exit codes. No other file prints
// errors.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "barriers/plugins.hpp"
#include "core/math/error.hpp"
#include "core/record/writer.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/verbs.hpp"

namespace {

using namespace bb::cli;

int guarded(const std::function<int()>& verb) {
  try {
    return verb();
  } catch (const bb::ConfigError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return exit_bad_input;
  } catch (const bb::RecordError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return error.lasting ? exit_bad_input : exit_try_again;
  } catch (const bb::Interrupted&) {
    fmt::print(stderr, "interrupted: no record was written; the same command runs it again\n");
    return exit_try_again;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "out of memory\n");
    return exit_try_again;
  } catch (const std::exception& error) {
    fmt::print(stderr, "internal error: {}\n", error.what());
    return exit_internal;
  }
}

void config_arguments(CLI::App* app, RunVerb& verb) {
  app->add_option("config", verb.config, "a config file, e.g. configs/scenes/drape2d.json")->required();
  app->add_option("--set", verb.set, "override: /pointer=value, e.g. /time/dt_s=0.005")
      ->allow_extra_args(false);
}

}  // namespace

int main(int argc, char** argv) {
  CommonOptions common;
  common.argv.assign(argv, argv + argc);
  RunVerb run_verb, check_verb, explain_verb;
  SweepVerb sweep_verb;
  std::string list_what = "all", eval_file = "-", demo_out = "results/runs/demo";
  bool eval_schema = false;

  CLI::App app{"barrierbench: contact barriers compared in one Newton + ACCD pipeline"};
  app.name("bench");
  app.require_subcommand(1);
  app.add_option("--plugin", common.plugins, "a plugin (.so) with shapes, stiffness policies or integrators")
      ->allow_extra_args(false);
  app.add_option("--progress", common.progress, "auto, plain or none")
      ->check(CLI::IsMember({"auto", "plain", "none"}));
  app.fallthrough();

  auto* run_app = app.add_subcommand("run", "one config, one record");
  config_arguments(run_app, run_verb);
  run_app->add_option("--out", run_verb.out, "folder of run.json (default results/runs/<label>)");
  run_app->footer("example: ./bench run configs/scenes/drape2d.json --set /formulation=\"cubic\"");
  auto* sweep_app =
      app.add_subcommand("sweep", "a base config and axes: one record a run, finished ones skipped");
  sweep_app->add_option("spec", sweep_verb.spec, "a sweep file, e.g. configs/sweeps/demo_strip.json")
      ->required();
  sweep_app->add_option("--set", sweep_verb.set, "override in every case")->allow_extra_args(false);
  sweep_app->add_option("--out", sweep_verb.out, "folder (default results/runs/<name>)");
  sweep_app->add_flag("--dry-run", sweep_verb.dry_run, "print what would run");
  sweep_app->add_flag("--again", sweep_verb.again, "run finished ones too");
  sweep_app->footer("example: ./bench sweep configs/sweeps/demo_strip.json --dry-run");
  auto* check_app = app.add_subcommand("check", "parse a config, build its scene, look for intersections");
  config_arguments(check_app, check_verb);
  check_app->footer("example: ./bench check configs/scenes/drape.json");
  auto* explain_app = app.add_subcommand("explain", "what a run would do, what it would skip, and why");
  config_arguments(explain_app, explain_verb);
  explain_app->footer("example: ./bench explain configs/scenes/drape2d.json");
  auto* list_app = app.add_subcommand("list", "what can be named in a config");
  list_app->add_option(
      "what", list_what,
      "all, shapes, policies, integrators, step_solvers, scenes, linear_solvers, membranes or "
      "formulations");
  list_app->footer("example: ./bench list shapes");
  auto* eval_app = app.add_subcommand("eval", "JSON Lines queries to the functions that the pipeline runs");
  eval_app->add_option("file", eval_file, "queries, - for standard input");
  eval_app->add_flag("--schema", eval_schema, "print the JSON Schema of all kinds");
  eval_app->footer(
      "example: echo '{\"kind\":\"shape\",\"shape\":\"log\",\"d\":0.5,\"d_hat\":1}' | ./bench eval");
  auto* demo_app = app.add_subcommand("demo", "the comparison of the README");
  demo_app->add_option("--out", demo_out, "folder of the records");
  demo_app->footer("example: ./bench demo");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? exit_ok : exit_bad_input;
  }
  // The verbs that ask whether to stop; the others end at the signal itself.
  if (run_app->parsed() || sweep_app->parsed() || demo_app->parsed()) install_interrupt();
  const int code = guarded([&]() -> int {
    for (const std::string& file : common.plugins) bb::register_plugin(file);
    if (run_app->parsed()) return run(run_verb, common);
    if (sweep_app->parsed()) return sweep(sweep_verb, common);
    if (check_app->parsed()) return check(check_verb);
    if (explain_app->parsed()) return explain(explain_verb);
    if (list_app->parsed()) return list(list_what);
    if (eval_app->parsed()) return eval(eval_file, eval_schema);
    return demo(demo_out, common);
  });
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  fmt::print(stderr, "the standard output cannot be written\n");
  return code == exit_ok ? exit_try_again : code;
}
