#include "experiments/cli/sweep_spec.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

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

/// What one case is: its config, or what is wrong with it.
struct Resolved {
  RunConfig config;
  nlohmann::json document;
  std::string key;  // that no other case may have: the number of threads belongs to it, and the repetition
  std::optional<ConfigError> error;
};

Resolved resolve(const SweepSpec& spec, SweepCase& one) {
  Resolved out;
  try {
    out.config = load_config(spec.base, one.set);
    if (spec.seeded && out.config.seeds.jitter == 0) {
      throw ConfigError("#/seeds/jitter_m", "0",
                        "a number above 0 beside `seed` in the sweep file: nothing else reads the seed");
    }
  } catch (const ConfigError& error) {
    out.error = error;
  }
  return out;
}

/// The rest, one case after the other: the choice of `auto` orders a matrix by METIS, whose random numbers are the process's.
void identify(Resolved& found, SweepCase& one, const SeenCase& seen) {
  decide_linear_solver(found.config);
  found.document = resolved_document(found.config);
  one.config_id = config_id_of(found.document);
  const auto repetition = one.swept.find("repetition");
  found.key =
      sha256_hex(found.document.dump()) + (repetition == one.swept.end() ? "" : " " + repetition->second);
  if (seen) seen(one, found.config, found.document);
}

/// Cases that are resolved side by side before the next are begun: a document has tens of kilobytes.
constexpr std::size_t side_by_side = 256;

}  // namespace

RunConfig resolved(const SweepSpec& spec, const SweepCase& one) { return load_run(spec.base, one.set); }

SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides,
                     std::optional<std::size_t> only, const SeenCase& seen) {
  SweepSpec out = parse_sweep(read_input_file(path, sweep_file), path);
  out.base = (std::filesystem::path(path).parent_path() / out.base).string();
  std::vector<Violation> violations;
  check_overrides(out, overrides, violations);
  std::map<std::string, const std::string*> label_of;  // key of a run -> the first case that is it
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < out.cases.size(); ++i) {
    out.cases[i].set.insert(out.cases[i].set.end(), overrides.begin(), overrides.end());
    if (!only || *only == i) asked.push_back(i);
  }
  std::vector<Resolved> found;
  for (std::size_t begin = 0; begin < asked.size() && violations.size() < max_violations;
       begin += side_by_side) {
    found.resize(std::min(side_by_side, asked.size() - begin));
    oneapi::tbb::parallel_for(std::size_t{0}, found.size(),
                              [&](std::size_t k) { found[k] = resolve(out, out.cases[asked[begin + k]]); });
    for (std::size_t k = 0; k < found.size() && violations.size() < max_violations; ++k) {
      SweepCase& one = out.cases[asked[begin + k]];
      check_plain_name(path + " [" + one.label.substr(0, max_name_bytes) + "]", one.label, violations);
      try {
        if (found[k].error) throw ConfigError(*found[k].error);
        identify(found[k], one, seen);
      } catch (const ConfigError& error) {
        append_violations(path, one, error, violations);
        continue;
      }
      const auto [first, is_new] = label_of.emplace(std::move(found[k].key), &one.label);
      if (is_new) continue;
      violations.push_back({path + " [" + one.label + "]", "the same run as [" + *first->second + "]",
                            "cases that differ in a setting"});
    }
  }
  if (!violations.empty()) throw ConfigError(violations);
  return out;
}

}  // namespace bb
