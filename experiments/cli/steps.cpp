// The verb steps: a table of single steps on stdout, and their residuals in a file for the figure.
#include <fmt/format.h>

#include "core/record/writer.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/step_study.hpp"

namespace bb::cli {
namespace {

std::string in_tolerances(const Number& error, double tolerance) {
  return error.finite() ? fmt::format("{:.3g}", error.value / tolerance) : "-";
}

}  // namespace

int steps(const StepsVerb& verb, const CommonOptions& common) {
  const RunConfig config = load_run(verb.config, verb.set);
  RunOptions options = run_options(common);
  const std::vector<StepTrial> trials = study_steps(config, verb.at, options);
  fmt::print("{:>5} {:<17} {:>10} {:>7} {:>7} {:>10} {:>10}  {}\n", "step", "hessian", "iterations", "solves",
             "failed", "estimate", "error", "status");
  for (const StepTrial& t : trials) {
    fmt::print("{:>5} {:<17} {:>10} {:>7} {:>7} {:>10} {:>10}  {}\n", t.step, t.hessian, t.newton_iterations,
               t.linear_solves, t.hessian_fallbacks, in_tolerances(t.error_estimate_m, t.tolerance_m),
               in_tolerances(t.error_true_m, t.tolerance_m), to_string(t.status));
  }
  fmt::print(
      "estimate and error in tolerances of {:.3g} m; error: against the step at a thousandth of it, from the "
      "same state\n",
      trials.front().tolerance_m);
  if (!verb.out.empty()) write_atomically(verb.out, to_json(config, trials));
  return exit_ok;
}

}  // namespace bb::cli
