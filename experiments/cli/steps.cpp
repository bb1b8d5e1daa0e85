// The verb steps: a table of single steps on stdout, and their residuals in a file for the figure.
#include <fmt/format.h>

#include "core/base/record/writer.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/step_study.hpp"

namespace bb::cli {
namespace {

struct StepsVerb {
  std::string config;
  std::vector<std::string> set;
  std::vector<int> at;  // steps, from 0
  std::string out;      // JSON file; empty: none
};

std::string in_tolerances(const Number& error, double tolerance) {
  return error.finite() ? fmt::format("{:.3g}", error.value / tolerance) : "-";
}

/// Single steps of a run with every choice of Hessian: study_steps() as a table.
int steps(const StepsVerb& verb, const CommonOptions& common) {
  const RunConfig config = load_run(verb.config, verb.set);
  RunOptions options = run_options(common);
  const std::vector<StepTrial> trials = study_steps(config, verb.at, options);
  show("{:>5} {:<17} {:>10} {:>7} {:>7} {:>10} {:>10}  {}\n", "step", "hessian", "iterations", "solves",
       "failed", "estimate", "error", "status");
  for (const StepTrial& t : trials) {
    show("{:>5} {:<17} {:>10} {:>7} {:>7} {:>10} {:>10}  {}\n", t.step, t.hessian, t.newton_iterations,
         t.linear_solves, t.hessian_fallbacks, in_tolerances(t.error_estimate_m, t.tolerance_m),
         in_tolerances(t.error_true_m, t.tolerance_m), to_string(t.status));
  }
  show(
      "estimate and error in tolerances of {:.3g} m; error: against the step at a thousandth of it, from the "
      "same state\n",
      trials.front().tolerance_m);
  if (!verb.out.empty()) write_atomically(verb.out, to_json(config, trials));
  return exit_ok;
}

}  // namespace

Action verb::steps(CLI::App& app) {
  const auto verb = std::make_shared<StepsVerb>();
  app.add_option("config", verb->config, "a config file")->required();
  set_argument(app, verb->set, "override: /pointer=value");
  app.add_option("--at", verb->at, "steps, from 0, ascending, with commas between")
      ->required()
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--out", verb->out, "JSON file with every |dx|, for ./bench figures");
  return [verb](const CommonOptions& common) { return install_interrupt(), cli::steps(*verb, common); };
}

}  // namespace bb::cli
