#include "experiments/cli/sweep_spec.hpp"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <unordered_map>

#include "core/base/input/names.hpp"
#include "core/base/input/read_file.hpp"
#include "core/base/record/provenance.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/sweep_cases.hpp"
#include "experiments/config/config_family.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/linear_choice.hpp"

namespace bb {

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

/// What one case is: its id, or what is wrong with it.
struct Resolved {
  std::string config_id;
  std::string key;  // that no other case may have: the number of threads belongs to it, and the repetition
  std::optional<RunConfig> undecided;  // a config whose linear solver is `auto`
  std::optional<ConfigError> error;
};

/// The threads of one call, each with a family of configs of its own.
using Families = oneapi::tbb::enumerable_thread_specific<std::optional<ConfigFamily>>;

Resolved resolve(const SweepSpec& spec, std::size_t i, Families& families, const SeenCase& seen) {
  Resolved out;
  try {
    std::optional<ConfigFamily>& family = families.local();
    if (!family) family.emplace(spec.base);
    const RunConfig& config = family->read(spec.cases[i].set);
    if (spec.seeded && config.seeds.jitter == 0) {
      throw ConfigError("#/seeds/jitter_m", "0",
                        "a number above 0 beside `seed` in the sweep file: nothing else reads the seed");
    }
    if (config.linear_solver.name == linear_solver_auto) {
      out.undecided = config;
      return out;
    }
    ConfigFamily::Identity identity = family->identity();
    if (seen) seen(i, config, identity.scene);
    out.config_id = std::move(identity.config_id);
    out.key = std::move(identity.document);
  } catch (const ConfigError& error) {
    out.error = error;
  }
  return out;
}

/// One case after the other: the choice of `auto` needs the scene of a case.
void decide(Resolved& found, std::size_t i, const SeenCase& seen) {
  if (!found.undecided) return;
  decide_linear_solver(*found.undecided);
  const nlohmann::json document = resolved_document(*found.undecided);
  found.config_id = config_id_of(document);
  found.key = sha256_hex(document.dump());
  if (seen) seen(i, *found.undecided, sha256_hex(document["scene"].dump()));
}

/// Cases that are resolved side by side before the next are begun, and those of them that a thread takes one after the other: neighbours
/// share most of their settings.
constexpr std::size_t side_by_side = 4096, a_thread_at_once = 128;

/// Cases side by side. found: one a case.
void resolve_all(const SweepSpec& spec, std::span<const std::size_t> cases, Families& families,
                 const SeenCase& seen, std::vector<Resolved>& found) {
  found.clear();
  found.resize(cases.size());
  const oneapi::tbb::blocked_range<std::size_t> all(0, found.size(), a_thread_at_once);
  oneapi::tbb::parallel_for(
      all,
      [&](const oneapi::tbb::blocked_range<std::size_t>& some) {
        for (std::size_t k = some.begin(); k < some.end(); ++k)
          found[k] = resolve(spec, cases[k], families, seen);
      },
      oneapi::tbb::simple_partitioner());
}

/// The key of a run, and the label of the first case that is it.
using FirstOfRuns = std::unordered_map<std::string, const std::string*>;

/// Gives case i its id, or says what is wrong with it, as that an earlier case is the same run.
void settle_case(const std::string& path, std::size_t i, Resolved& found, const SeenCase& seen,
                 SweepSpec& spec, FirstOfRuns& first_of, std::vector<Violation>& violations) {
  SweepCase& one = spec.cases[i];
  check_plain_name(path + " [" + one.label.substr(0, max_name_bytes) + "]", one.label, violations);
  try {
    if (found.error) throw ConfigError(*found.error);
    decide(found, i, seen);
  } catch (const ConfigError& error) {
    append_violations(path, one, error, violations);
    return;
  }
  one.config_id = std::move(found.config_id);
  if (const auto at = one.swept.find("repetition"); at != one.swept.end()) found.key += " " + at->second;
  const auto [first, is_new] = first_of.emplace(std::move(found.key), &one.label);
  if (is_new) return;
  violations.push_back({path + " [" + one.label + "]", "the same run as [" + *first->second + "]",
                        "cases that differ in a setting"});
}

}  // namespace

RunConfig resolved(const SweepSpec& spec, const SweepCase& one) { return load_run(spec.base, one.set); }

void append_violations(const std::string& path, const SweepCase& one, const ConfigError& error,
                       std::vector<Violation>& violations) {
  for (Violation v : error.violations()) {
    v.where = path + " [" + one.label.substr(0, max_name_bytes) + "] " + v.where;
    violations.push_back(std::move(v));
  }
}

SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides,
                     std::optional<std::size_t> only, const SeenCase& seen) {
  SweepSpec out = parse_sweep(read_input_file(path, sweep_file), path);
  out.base = (std::filesystem::path(path).parent_path() / out.base).string();
  std::vector<Violation> violations;
  check_overrides(out, overrides, violations);
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < out.cases.size(); ++i) {
    out.cases[i].set.insert(out.cases[i].set.end(), overrides.begin(), overrides.end());
    if (!only || *only == i) asked.push_back(i);
  }
  FirstOfRuns first_of;
  Families families;
  std::vector<Resolved> found;
  for (std::size_t begin = 0; begin < asked.size() && violations.size() < max_violations;
       begin += side_by_side) {
    const std::size_t n = std::min(side_by_side, asked.size() - begin);
    const auto some = std::span<const std::size_t>(asked).subspan(begin, n);
    resolve_all(out, some, families, seen, found);
    for (std::size_t k = 0; k < n && violations.size() < max_violations; ++k)
      settle_case(path, some[k], found[k], seen, out, first_of, violations);
  }
  if (!violations.empty()) throw ConfigError(violations);
  return out;
}

}  // namespace bb
