// A sweep as data: a base config and axes; every combination is one run.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/config/run_config.hpp"

namespace bb {

/// Most combinations of the axes of one sweep.
inline constexpr std::size_t max_sweep_cases = 10000;

struct SweepCase {
  std::string label;                         // "log dt=0.01"
  std::vector<std::string> set;              // overrides "/pointer=value"
  std::map<std::string, std::string> swept;  // pointer -> JSON text, of the axes
  RunConfig config;
  std::optional<std::size_t> reference;  // the case it is compared with, where the file marks one
  std::size_t group = 0;  // the same for cases that differ in formulation, strain limit and matching only
};

struct SweepSpec {
  std::string name;
  std::string text;  // as read, for sweep.json
  std::string base;  // a config, relative to the file
  std::vector<SweepCase> cases;
};

/// Reads a sweep file (configs/schema/sweep.schema.json) and resolves every case, so that a mistake in the
/// last one is found before the first one runs. A case of an axis with "reference": true (one an axis at
/// most) is what the others of that axis are compared with, at equal values of the other axes. Errors:
/// ConfigError with the violations: of the file, of its size (max_sweep_cases, counted before anything is
/// expanded), else of its cases, also of two cases that are the same run, and of an override that undoes an axis.
SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace bb
