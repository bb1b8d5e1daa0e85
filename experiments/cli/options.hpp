// Options that several verbs declare.
#pragma once

#include <CLI/CLI.hpp>

#include "experiments/cli/verb.hpp"

namespace bb::cli {

/// Refuses an empty value of every option that takes one, which would be 0 or the default. Arguments without a name say themselves what
/// they need.
void refuse_empty_values(CLI::App& app);
/// A finite number from low (or above it) to high; CLI::Range lets NaN through.
CLI::Validator finite_number(double low, double high, bool above_low = false);

/// The config, and --set.
void config_arguments(CLI::App& app, RunVerb& verb);

/// --set.
void set_argument(CLI::App& app, std::vector<std::string>& set, const std::string& doc);

/// --resume and --time-limit.
void limit_arguments(CLI::App& app, RunLimits& limits);

}  // namespace bb::cli
