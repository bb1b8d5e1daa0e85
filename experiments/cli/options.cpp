#include "experiments/cli/options.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bb::cli {

CLI::Validator finite_number(double low, double high, bool above_low) {
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

void refuse_empty_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 0 || !option->nonpositional()) continue;
    option->check(
        [](const std::string& text) { return text.empty() ? "found nothing; allowed: a value" : ""; });
  }
}

void set_argument(CLI::App& app, std::vector<std::string>& set, const std::string& doc) {
  app.add_option("--set", set, doc)->allow_extra_args(false);
}

void config_arguments(CLI::App& app, RunVerb& verb) {
  app.add_option("config", verb.config,
                 "a config file, e.g. configs/scenes/drape2d.json; - reads the standard input")
      ->required();
  set_argument(app, verb.set, "override: /pointer=value, e.g. /time/dt_s=0.005");
}

void RunLimits::put_in(RunOptions& options) const {
  options.time_limit_s = time_limit_s;
  options.step_limit = step_limit;
}

void limit_arguments(CLI::App& app, RunLimits& limits) {
  app.add_flag(
      "--resume", limits.resume,
      "go on from the checkpoint of a run that was stopped by a signal, its time limit or a lack of memory, "
      "or killed (/output/checkpoint_every); without one, from the start");
  app.add_option("--time-limit", limits.time_limit_s,
                 "seconds that one run may take: it ends between two steps with the outcome timeout, and "
                 "--resume goes on")
      ->check(finite_number(0, 1e9, true));
  app.add_option(
         "--step-limit", limits.step_limit,
         "steps of a pass after which the run ends with the outcome timeout, on a machine of any speed; "
         "--resume goes on for as many")
      ->check(CLI::Range(1, 1000000000));
}

}  // namespace bb::cli
