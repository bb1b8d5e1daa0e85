#include "experiments/cli/sweep_spec.hpp"

#include <filesystem>

#include "core/input/names.hpp"
#include "core/input/read_file.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/sweep_cases.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"

namespace bb {

constexpr std::size_t max_violations = 50;  // of all cases together; each is named once

namespace {

/// An override of the command line that replaces what an axis sets would make its cases the same run.
void check_overrides(const SweepSpec& spec, const std::vector<std::string>& overrides,
                     std::vector<Violation>& violations) {
  for (const std::string& text : overrides) {
    const std::string pointer = text.substr(0, text.find('='));
    for (const auto& [swept, value] : spec.cases.front().swept) {
      if (swept != pointer && !swept.starts_with(pointer + "/")) continue;
      violations.push_back({"--set " + shortened(text), '"' + swept + "\" is set by an axis of the sweep",
                            "a pointer that no axis sets"});
    }
  }
}

/// Every case has to be a run of its own; the number of threads makes one.
void check_distinct(const SweepSpec& spec, const std::string& path, std::vector<Violation>& violations) {
  std::map<std::string, const std::string*> label_of_config;
  for (const SweepCase& one : spec.cases) {
    const auto [first, is_new] = label_of_config.emplace(resolved_json(one.config), &one.label);
    if (is_new || violations.size() >= max_violations) continue;
    violations.push_back({path + " [" + one.label + "]", "the same run as [" + *first->second + "]",
                          "cases that differ in a setting"});
  }
}

}  // namespace

SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides) {
  SweepSpec out = parse_sweep(read_input_file(path, sweep_file), path);
  const auto base = std::filesystem::path(path).parent_path() / out.base;
  std::vector<Violation> violations;
  check_overrides(out, overrides, violations);
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
  if (violations.empty()) check_distinct(out, path, violations);
  if (!violations.empty()) throw ConfigError(violations);
  return out;
}

}  // namespace bb
