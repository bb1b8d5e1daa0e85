#include "experiments/cli/sweep_spec.hpp"

#include <filesystem>

#include "core/input/names.hpp"
#include "core/input/read_file.hpp"
#include "core/math/error.hpp"
#include "core/record/provenance.hpp"
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

/// What is wrong with a case, named by its label.
void append_violations(const std::string& path, const SweepCase& one, const ConfigError& error,
                       std::vector<Violation>& violations) {
  for (Violation v : error.violations()) {
    v.where = path + " [" + one.label.substr(0, max_name_bytes) + "] " + v.where;
    violations.push_back(std::move(v));
  }
}

/// Reads the config of one case: its id, and the key that no other case may have, to which the number of threads belongs
/// and the repetition.
std::string resolve(const SweepSpec& spec, SweepCase& one, const SeenCase& seen) {
  const RunConfig config = resolved(spec, one);
  if (spec.seeded && config.seeds.jitter == 0) {
    throw ConfigError("#/seeds/jitter_m", "0",
                      "a number above 0 beside `seed` in the sweep file: nothing else reads the seed");
  }
  const std::string text = resolved_json(config);
  one.config_id = config_id(std::string_view(text));
  if (seen) seen(one, config);
  const auto repetition = one.swept.find("repetition");
  return sha256_hex(text) + (repetition == one.swept.end() ? "" : " " + repetition->second);
}

}  // namespace

RunConfig resolved(const SweepSpec& spec, const SweepCase& one) { return load_run(spec.base, one.set); }

SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides,
                     std::optional<std::size_t> only, const SeenCase& seen) {
  SweepSpec out = parse_sweep(read_input_file(path, sweep_file), path);
  out.base = (std::filesystem::path(path).parent_path() / out.base).string();
  std::vector<Violation> violations;
  check_overrides(out, overrides, violations);
  std::map<std::string, const std::string*> label_of;  // key of a run -> the first case that is it
  for (std::size_t i = 0; i < out.cases.size() && violations.size() < max_violations; ++i) {
    SweepCase& one = out.cases[i];
    one.set.insert(one.set.end(), overrides.begin(), overrides.end());
    if (only && *only != i) continue;
    check_plain_name(path + " [" + one.label.substr(0, max_name_bytes) + "]", one.label, violations);
    try {
      const auto [first, is_new] = label_of.emplace(resolve(out, one, seen), &one.label);
      if (is_new) continue;
      violations.push_back({path + " [" + one.label + "]", "the same run as [" + *first->second + "]",
                            "cases that differ in a setting"});
    } catch (const ConfigError& error) {
      append_violations(path, one, error, violations);
    }
  }
  if (!violations.empty()) throw ConfigError(violations);
  return out;
}

}  // namespace bb
