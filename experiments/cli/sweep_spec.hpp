// A sweep as data: a base config and axes; every combination is one run.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/math/error.hpp"
#include "experiments/config/config_list.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

struct SweepCase {
  std::string label;             // "log dt=0.01"
  std::vector<std::string> set;  // overrides "/pointer=value"
  std::map<std::string, std::string>
      swept;  // pointer -> JSON text, of the axes; "repetition" of a repeated sweep
  std::string config_id;
  std::optional<std::size_t> reference;  // the case it is compared with, where the file marks one
  std::size_t group = 0;  // the same for cases that differ in formulation, strain limit and matching only
};

/// What a sweep may cost; 0: no bound.
struct SweepBudget {
  double core_s = 0;  // of all runs
  double run_s = 0;   // of one
};

struct SweepSpec {
  std::string name;
  std::string text;   // as read, for sweep.json
  std::string base;   // a config; load_sweep makes it relative to the working folder
  std::string shape;  // "3 x 4 x 2 repetitions", before exclusions
  std::size_t excluded = 0;
  bool seeded = false;
  SweepBudget budget;
  std::vector<SweepCase> cases;
};

/// The config of one case. Errors: ConfigError, as load_run.
RunConfig resolved(const SweepSpec& spec, const SweepCase& one);

/// A case as it is resolved: its index, its config, and the SHA-256 of the section `scene` of that (ConfigFamily::Identity). Called
/// by several threads at once, in no order.
using SeenCase = std::function<void(std::size_t, const RunConfig&, const std::string& scene)>;

/// Violations that all cases together are refused with; each is named once.
inline constexpr std::size_t max_violations = 50;
/// What is wrong with a case of the sweep file at `path`, named by its label.
void append_violations(const std::string& path, const SweepCase& one, const ConfigError& error,
                       std::vector<Violation>& violations);

/// Reads a sweep file (configs/schema/sweep.schema.json) and resolves every case, so that a mistake in the
/// last one is found before the first one runs. A case of an axis with "reference": true (one an axis at
/// most) is what the others of that axis are compared with, at equal values of the other axes. Errors:
/// ConfigError with the violations: of the file, of its size (max_sweep_cases, counted before anything is
/// expanded), else of its cases, also of two cases that are the same run, and of an override that undoes an axis.
/// only: the one case that is resolved; nothing is known of the others then but their labels. seen: called with every config as
/// it is resolved. Cost: about 40 us a case of one thread (the cases of a sweep share most of what there is to read), and 0.3 ms where the
/// linear solver is `auto`.
SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides,
                     std::optional<std::size_t> only = {}, const SeenCase& seen = {});

}  // namespace bb
