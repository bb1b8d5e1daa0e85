#include "experiments/cli/sweep_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/input/json.hpp"
#include "core/base/input/names.hpp"
#include "core/base/parameters/check.hpp"
#include "core/base/record/provenance.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/sweep_axes.hpp"
#include "experiments/config/config_list.hpp"
#include "experiments/config/document.hpp"
#include "experiments/config/renamed_settings.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// Combinations of all axes, as a double: the product may be beyond any integer.
double count_cases(const json& spec) {
  double count = static_cast<double>(spec.value("repeat", 1));
  for (const json& axis : spec["axes"]) count *= static_cast<double>(count_entries(axis));
  return count;
}

struct Axes {
  std::vector<Axis> list;        // the repetitions of a repeated sweep last
  std::vector<bool> of_problem;  // one an axis: it leaves alone what is compared
  bool repeated = false;

  void add(Axis axis) {
    of_problem.push_back(!changes_formulation(axis));
    list.push_back(std::move(axis));
  }
  std::size_t size() const { return list.size(); }
  const Axis& operator[](std::size_t a) const { return list[a]; }
};

/// The entry of each axis in combination `index`; the last axis runs fastest.
std::vector<std::size_t> digits_of(const Axes& axes, std::size_t index) {
  std::vector<std::size_t> out(axes.size());
  for (std::size_t a = axes.size(); a-- > 0;) {
    out[a] = index % axes[a].size();
    index /= axes[a].size();
  }
  return out;
}

/// Index of the entry of an axis with "reference": true.
std::optional<std::size_t> marked_entry(const Axis& axis) {
  const auto found =
      std::find_if(axis.begin(), axis.end(), [](const AxisEntry& entry) { return entry.reference; });
  return found == axis.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - axis.begin()));
}

/// The combination that differs in the axes with a mark only, where it is the marked one. Nothing without any mark.
std::optional<std::size_t> marked_reference(const Axes& axes, const std::vector<std::size_t>& digits) {
  std::size_t out = 0;
  bool any = false;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const auto marked = marked_entry(axes[a]);
    any = any || marked;
    out = out * axes[a].size() + marked.value_or(digits[a]);
  }
  return any ? std::optional(out) : std::nullopt;
}

/// Repetitions as an axis that sets nothing.
Axis repetitions(std::size_t n) {
  Axis out;
  for (std::size_t k = 1; k <= n; ++k) out.push_back({fmt::format("r{}", k), json::object(), false});
  return out;
}

/// Pointer -> the first axis that sets it.
using AxisOf = std::map<std::string, std::size_t>;

/// `seed` gives every run its seed, so nothing else may.
void check_seed(const json& spec, const AxisOf& axis_of, const std::string& path,
                std::vector<Violation>& violations) {
  for (const char* pointer : {"/seeds/main", "/seeds"}) {
    if (!spec.contains("seed") ||
        (!axis_of.contains(pointer) && !spec.value("set", json::object()).contains(pointer)))
      continue;
    violations.push_back({path + "#/seed",
                          fmt::format("a seed beside \"{}\", which the file sets too", pointer),
                          "one of the two: the runs have one seed"});
  }
}

/// Everything that the file alone determines, counted before anything is expanded. The axes.
Axes checked_axes(json spec, const std::string& path) {
  require_format(spec, "barrierbench.sweep/1", path);
  std::vector<Violation> violations;
  Rule rule;
  rule.kind = Kind::object;
  rule.list = [](const json&) { return sweep_list(); };
  check_value(spec, rule, path + "#", violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  check_plain_name(path + "#/name", spec["name"].get<std::string>(), violations);
  if (spec.contains("set")) check_pointers(path + "#/set", spec["set"], violations);
  if (const double n = count_cases(spec); n > static_cast<double>(max_sweep_cases)) {
    throw ConfigError(path + "#/axes", fmt::format("{} combinations", n),
                      fmt::format("at most {} cases in one sweep", max_sweep_cases));
  }
  Axes axes;
  AxisOf axis_of;
  for (std::size_t i = 0; i < spec["axes"].size(); ++i) {
    const std::string where = fmt::format("{}#/axes/{}", path, i);
    axes.add(expand_axis(where, spec["axes"][i], violations));
    for (const std::string& pointer : pointers_of(axes.list.back())) {
      json value;  // of no matter: an earlier name and the present one are one setting
      if (const auto [earlier, is_new] = axis_of.emplace(present_pointer(pointer, value), i); !is_new) {
        violations.push_back(
            {where, fmt::format("\"{}\", which axis {} sets too", shortened(pointer), earlier->second),
             "pointers that no other axis sets: the later one would undo the earlier one"});
      }
    }
  }
  check_seed(spec, axis_of, path, violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  if (const auto n = spec.value("repeat", std::size_t{1}); n > 1) {
    axes.add(repetitions(n));
    axes.repeated = true;
  }
  return axes;
}

/// A combination before it is kept or left out.
struct Combination {
  SweepCase one;
  json values = json::object();  // pointer -> value, of all axes
  std::set<std::string> labels;
};

void append_set(const json& set, std::vector<std::string>& overrides) {
  for (const auto& [pointer, value] : set.items()) overrides.push_back(pointer + "=" + value.dump());
}

Combination combine(const Axes& axes, const std::vector<std::size_t>& digits) {
  Combination out;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const AxisEntry& entry = axes[a][digits[a]];
    out.one.label += (out.one.label.empty() ? "" : " ") + entry.label;
    append_set(entry.set, out.one.set);
    out.values.update(entry.set);
    out.labels.insert(entry.label);
    if (axes.of_problem[a]) out.one.group = out.one.group * axes[a].size() + digits[a];
  }
  for (const auto& [pointer, value] : out.values.items()) out.one.swept[pointer] = value.dump();
  if (axes.repeated) out.one.swept["repetition"] = std::to_string(digits.back() + 1);
  return out;
}

/// The seed of a run: of `main`, the repetition and what the axes set that do not change the formulation. 48 bits of a SHA-256.
std::uint64_t seed_of(std::uint64_t main, const Axes& axes, const std::vector<std::size_t>& digits,
                      const SweepCase& one) {
  std::map<std::string, std::string> of_problem;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!axes.of_problem[a]) continue;
    for (const auto& [pointer, value] : axes[a][digits[a]].set.items()) of_problem[pointer] = value.dump();
  }
  if (const auto found = one.swept.find("repetition"); found != one.swept.end()) of_problem.insert(*found);
  std::string text = std::to_string(main) + "\n";
  for (const auto& [pointer, value] : of_problem) text.append(pointer).append("=").append(value).append("\n");
  return std::stoull(sha256_hex(text).substr(0, 12), nullptr, 16);
}

/// One rule of `exclude`.
bool leaves_out(const json& rule, const Combination& combination) {
  const json where = rule.value("where", json::object());
  for (const auto& [pointer, wanted] : where.items()) {
    if (!combination.values.contains(pointer)) return false;
    const json& value = combination.values[pointer];
    const bool one_of = wanted.is_array() && std::find(wanted.begin(), wanted.end(), value) != wanted.end();
    if (value != wanted && !one_of) return false;
  }
  const json labels = rule.value("labels", json::array());
  return std::all_of(labels.begin(), labels.end(), [&](const json& label) {
    return label.is_string() && combination.labels.contains(label.get<std::string>());
  });
}

/// Whether a rule of `exclude` leaves a combination out. met: how many each rule has met, counted on.
bool is_left_out(const json& rules, const Combination& combination, std::vector<std::size_t>& met) {
  bool out = false;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    if (!leaves_out(rules[r], combination)) continue;
    ++met[r];
    out = true;
  }
  return out;
}

/// What a case has beside what its axes set: its seed, and in front of all else the settings of the file.
void set_common(const json& spec, const Axes& axes, const std::vector<std::size_t>& digits, SweepCase& one) {
  if (spec.contains("seed")) {
    const std::string seed = std::to_string(seed_of(spec["seed"].get<std::uint64_t>(), axes, digits, one));
    one.set.push_back("/seeds/main=" + seed);
    one.swept["/seeds/main"] = seed;
  }
  if (spec.contains("set")) {
    std::vector<std::string> common;
    append_set(spec["set"], common);
    one.set.insert(one.set.begin(), common.begin(), common.end());
  }
}

/// A rule without a condition would leave out everything, one that meets nothing is a mistake.
void check_exclusions(const json& rules, const std::vector<std::size_t>& met, const std::string& path,
                      std::vector<Violation>& violations) {
  for (std::size_t r = 0; r < rules.size(); ++r) {
    if (met[r] > 0 && !rules[r].empty()) continue;
    violations.push_back({fmt::format("{}#/exclude/{}", path, r),
                          shortened(rules[r].dump()) + (met[r] > 0 ? "" : ", which no case is"),
                          "pointers that axes set with values that they take there, or labels of their "
                          "entries, which some case "
                          "has together"});
  }
}

/// Labels of all axes together, "a b" and "c" as "a" and "b c"; references that were left out.
void check_cases(const SweepSpec& spec, const std::string& path, std::vector<Violation>& violations) {
  std::set<std::string> labels;
  for (const SweepCase& one : spec.cases) {
    if (!labels.insert(one.label).second && violations.empty()) {
      violations.push_back({path + "#/axes", fmt::format("two cases \"{}\"", shortened(one.label)),
                            "labels whose combinations differ: records are distinguished by them"});
    }
  }
  if (spec.cases.empty()) {
    violations.push_back({path + "#/exclude", "exclusions that leave no case", "at least one run"});
  }
}

/// "3 x 4 x 2 repetitions".
std::string shape_of(const Axes& axes) {
  std::string out;
  for (const Axis& axis : axes.list) out += fmt::format("{}{}", out.empty() ? "" : " x ", axis.size());
  return out + (axes.repeated ? " repetitions" : "");
}

constexpr std::size_t left_out = static_cast<std::size_t>(-1);

/// References as places in the list of cases. kept: of each combination, its place or left_out.
void settle_references(const std::vector<std::size_t>& kept, const std::string& path, SweepSpec& spec,
                       std::vector<Violation>& violations) {
  for (SweepCase& one : spec.cases) {
    if (!one.reference) continue;
    one.reference = kept[*one.reference];
    if (*one.reference != left_out) continue;
    violations.push_back({path + "#/exclude",
                          fmt::format("the reference of \"{}\" is left out", shortened(one.label)),
                          "exclusions that keep what the other cases are compared with"});
    return;
  }
}

}  // namespace

SweepSpec parse_sweep(const std::string& text, const std::string& path) {
  SweepSpec out;
  out.text = text;
  const json spec = parse_json(text, path);
  const Axes axes = checked_axes(spec, path);
  out.name = spec["name"].get<std::string>();
  out.base = spec["base"].get<std::string>();
  out.seeded = spec.contains("seed");
  const json budget = spec.value("budget", json::object());
  out.budget = {budget.value("core_s", 0.0), budget.value("run_s", 0.0)};
  out.shape = shape_of(axes);
  const auto n = static_cast<std::size_t>(count_cases(spec));
  const json rules = spec.value("exclude", json::array());
  std::vector<std::size_t> met(rules.size()), kept(n, left_out);
  for (std::size_t i = 0; i < n; ++i) {
    const std::vector<std::size_t> digits = digits_of(axes, i);
    Combination combination = combine(axes, digits);
    if (is_left_out(rules, combination, met)) continue;
    SweepCase& one = combination.one;
    set_common(spec, axes, digits, one);
    one.reference = marked_reference(axes, digits);
    kept[i] = out.cases.size();
    out.cases.push_back(std::move(one));
  }
  out.excluded = n - out.cases.size();
  std::vector<Violation> violations;
  check_exclusions(rules, met, path, violations);
  check_cases(out, path, violations);
  if (violations.empty()) settle_references(kept, path, out, violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  return out;
}

}  // namespace bb
