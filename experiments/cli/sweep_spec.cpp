#include "experiments/cli/sweep_spec.hpp"

#include <filesystem>

#include "core/input/names.hpp"
#include "core/input/read_file.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/sweep_cases.hpp"
#include "experiments/run/linear_choice.hpp"

namespace bb {

constexpr std::size_t max_violations = 50;  // of all cases together; each is named once

SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides) {
  SweepSpec out = parse_sweep(read_input_file(path, sweep_file), path);
  const auto base = std::filesystem::path(path).parent_path() / out.base;
  std::vector<Violation> violations;
  for (SweepCase& one : out.cases) {
    if (violations.size() >= max_violations) break;
    check_plain_name(path + " [" + one.label.substr(0, max_name_bytes) + "]", one.label, violations);
    one.set.insert(one.set.end(), overrides.begin(), overrides.end());
    try {
      one.config = load_run(base.string(), one.set);
    } catch (const ConfigError& error) {
      for (Violation v : error.violations()) {
        v.where = path + " [" + one.label.substr(0, max_name_bytes) + "] " + v.where;
        violations.push_back(std::move(v));
      }
    }
  }
  if (!violations.empty()) throw ConfigError(violations);
  return out;
}

}  // namespace bb
