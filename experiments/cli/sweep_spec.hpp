// A sweep as data: a base config and axes; every combination is one run.
#pragma once

#include <string>
#include <vector>

#include "experiments/config/run_config.hpp"

namespace bb {

struct SweepCase {
  std::string label;             // "log dt=0.01"
  std::vector<std::string> set;  // overrides "/pointer=value"
  RunConfig config;
};

struct SweepSpec {
  std::string name;
  std::string text;  // as read, for sweep.json
  std::vector<SweepCase> cases;
};

/// Reads {"schema": "barrierbench.sweep/1", "name", "base": PATH, "set": {pointer: value}, "axes":
/// [{"pointer", "values"} or {"cases": [{"label", "set"}]}]} and resolves every case, so that a mistake in
/// the last one is found before the first one runs. Errors: ConfigError with every violation.
SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace bb
