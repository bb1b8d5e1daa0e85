// A sweep file from its text to a list of cases, before any of their configs is read.
#pragma once

#include <string>

#include "experiments/cli/sweep_spec.hpp"

namespace bb {

/// Every case of a sweep with its label, overrides, reference and group; `config` of the cases is not filled.
/// `path` is used in messages. Errors: ConfigError: JSON, settings, names, size (max_sweep_cases, counted before
/// anything is expanded). Cost: of the text, times the number of cases.
SweepSpec parse_sweep(const std::string& text, const std::string& path);

}  // namespace bb
