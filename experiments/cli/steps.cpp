// The verb steps: single steps of a run by every choice of Hessian, and states of steps: keeps one of a run, takes a folder of them
// by every step solver.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/base/record/writer.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/step_corpus.hpp"
#include "experiments/run/step_study.hpp"

namespace bb::cli {
namespace {

struct StepsVerb {
  std::string config;
  std::vector<std::string> set;
  std::vector<int> at;  // steps, from 0
  std::string out;      // JSON file; empty: none
  std::string keep;     // files of the state before the step, without their endings; empty: none
  std::string corpus;   // folder of states, with what is below
  std::vector<std::string> only, trials;
  bool without_reference = false;
  std::string split;
};

std::string in_tolerances(const Number& error, double tolerance) {
  return error.finite() ? fmt::format("{:.3g}", error.value / tolerance) : "-";
}

/// Single steps of a run with every choice of Hessian: study_steps() as a table.
int study(const StepsVerb& verb, const CommonOptions& common) {
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

int keep(const StepsVerb& verb, const CommonOptions& common) {
  if (verb.at.size() != 1)
    throw ConfigError("--keep", fmt::format("--at with {} steps", verb.at.size()), "one step");
  keep_step_state(load_run(verb.config, verb.set), verb.at.front(), verb.keep, run_options(common));
  show("{0}.json\n{0}.state\n", verb.keep);
  return exit_ok;
}

/// The states of --only, or all. Errors: ConfigError for a name that is not there.
std::vector<std::string> chosen_names(const StepsVerb& verb) {
  const std::vector<std::string> all = step_states_in(verb.corpus);
  for (const std::string& name : verb.only) {
    if (std::find(all.begin(), all.end(), name) == all.end())
      throw ConfigError("--only", '"' + name + '"',
                        fmt::format("states of {}: {}", verb.corpus, fmt::join(all, ", ")));
  }
  return verb.only.empty() ? all : verb.only;
}

/// All states are read before the first is taken; the record is written after each, so that an interrupt loses none.
int corpus(const StepsVerb& verb, const CommonOptions& common) {
  const CorpusChoice choice{corpus_trials(verb.trials), !verb.without_reference};
  std::vector<StepState> states;
  for (const std::string& name : chosen_names(verb)) {
    StepState state = read_step_state(verb.corpus, name);
    if (verb.split.empty() || state.split == verb.split) states.push_back(std::move(state));
  }
  if (states.empty())
    throw ConfigError("--split", '"' + verb.split + '"', "a split that one of the chosen states has");
  const RunOptions options = run_options(common);
  ProgressLine line(common);
  std::vector<CorpusState> out;
  for (const StepState& state : states) {
    out.push_back(take_state(state, choice, options, [&line](const std::string& text) { line.tell(text); }));
    line.clear();
    if (!verb.out.empty()) write_atomically(verb.out, corpus_json(out, options));
    show("{}", corpus_table(out.back()));
  }
  show(
      "error in tolerances, against the minimum of the letter (-: none is within 10 tolerances; the error is "
      "against A); A is that of line_search at a thousandth of the tolerance\n"
      "to tol: iterations until that error was first below the tolerance; factors, products: those of the "
      "check of the end too\n");
  return exit_ok;
}

/// Errors: ConfigError for options that do not go together.
int steps(const StepsVerb& verb, const CommonOptions& common) {
  const bool of_run = !verb.config.empty() || !verb.at.empty() || !verb.set.empty() || !verb.keep.empty();
  if (!verb.corpus.empty()) {
    if (of_run)
      throw ConfigError("--corpus", "a config, --at, --set or --keep with it",
                        "none of these: its states have their configs");
    return corpus(verb, common);
  }
  for (const auto& [option, given] : {std::pair("--only", !verb.only.empty()),
                                      {"--split", !verb.split.empty()},
                                      {"--trials", !verb.trials.empty()},
                                      {"--without-reference", verb.without_reference}}) {
    if (given) throw ConfigError(option, "no --corpus", "--corpus DIR with it");
  }
  if (verb.config.empty()) throw ConfigError("config", "nothing", "a config file, or --corpus DIR");
  if (verb.at.empty()) throw ConfigError("--at", "nothing", "steps of the run, from 0");
  return verb.keep.empty() ? study(verb, common) : keep(verb, common);
}

}  // namespace

Action verb::steps(CLI::App& app) {
  const auto verb = std::make_shared<StepsVerb>();
  app.add_option("config", verb->config, "a config file");
  set_argument(app, verb->set, "override: /pointer=value");
  app.add_option("--at", verb->at, "steps, from 0, ascending, with commas between")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--keep", verb->keep,
                 "keep the state before the step of --at as STEM.json and STEM.state, and take no step");
  app.add_option(
         "--corpus", verb->corpus,
         "take the states of a folder by every step solver and Hessian (without a value: results/steps)")
      ->expected(0, 1)
      ->default_str("results/steps");
  app.add_option("--only", verb->only, "of --corpus: states by name, with commas between")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--split", verb->split, "of --corpus: the half that options are tuned on, or the other one")
      ->check(CLI::IsMember({"tune", "report"}));
  app.add_option("--trials", verb->trials,
                 "of --corpus: trials by name, with commas between: a step solver, or line_search/HESSIAN "
                 "(without it: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_flag("--without-reference", verb->without_reference,
               "of --corpus: takes the trials alone, whose ends are then compared with no minimum");
  app.add_option("--out", verb->out,
                 "JSON file with every |dx|, for ./bench draw figures; of --corpus: its record, written "
                 "after each state");
  return [verb](const CommonOptions& common) { return install_interrupt(), cli::steps(*verb, common); };
}

}  // namespace bb::cli
