#include "experiments/cli/sweep_cases.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/input/json.hpp"
#include "core/input/names.hpp"
#include "core/math/error.hpp"
#include "core/parameters/check.hpp"
#include "experiments/config/config_list.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// The entries of an axis: its values or its cases.
const json& entries(const json& axis) { return axis.contains("cases") ? axis["cases"] : axis["values"]; }

/// Combinations of all axes, as a double: the product may be beyond any integer.
double count_cases(const json& axes) {
  double count = 1;
  for (const json& axis : axes) count *= static_cast<double>(entries(axis).size());
  return count;
}

/// Indices of the cases of an axis with "reference": true.
std::vector<std::size_t> marked_cases(const json& axis) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; axis.contains("cases") && k < axis["cases"].size(); ++k) {
    if (axis["cases"][k].value("reference", false)) out.push_back(k);
  }
  return out;
}

/// The case that differs from `index` in the axes with a mark only, where it is the marked one; the last axis
/// runs fastest. Nothing without any mark.
std::optional<std::size_t> marked_reference(const json& axes, std::size_t index) {
  std::size_t out = 0, stride = 1;
  bool any = false;
  for (std::size_t a = axes.size(); a-- > 0;) {
    const json& axis = axes[a];
    const std::size_t n = entries(axis).size();
    const std::vector<std::size_t> marked = marked_cases(axis);
    any = any || !marked.empty();
    out += stride * (marked.empty() ? index % n : marked.front());
    index /= n;
    stride *= n;
  }
  return any ? std::optional(out) : std::nullopt;
}

/// Whether an axis changes what is compared (method, formulation, strain limit, matching), and not the problem that
/// it is compared on. One entry that does is enough.
bool changes_formulation(const json& axis) {
  const auto compared = [](const std::string& pointer) {
    for (const char* section : {"/method", "/formulation", "/strain_limit", "/matching"}) {
      if (pointer == section || pointer.starts_with(std::string(section) + "/")) return true;
    }
    return false;
  };
  if (axis.contains("pointer")) return compared(axis["pointer"].get<std::string>());
  for (const json& one : axis["cases"]) {
    for (const auto& [pointer, value] : one["set"].items()) {
      if (compared(pointer)) return true;
    }
  }
  return false;
}

/// The number of the combination of all axes that change the problem; the last axis runs fastest.
std::size_t group_of(const json& axes, std::size_t index) {
  std::size_t out = 0, stride = 1;
  for (std::size_t a = axes.size(); a-- > 0;) {
    const std::size_t n = entries(axes[a]).size();
    if (!changes_formulation(axes[a])) {
      out += stride * (index % n);
      stride *= n;
    }
    index /= n;
  }
  return out;
}

/// KEY=VALUE. What a folder name cannot hold (paths) is replaced.
std::string value_label(const std::string& pointer, const json& value) {
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  for (char& c : text) {
    if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  }
  for (std::size_t at; (at = text.find("..")) != std::string::npos;) text.replace(at, 2, "_");
  return pointer.substr(pointer.rfind('/') + 1) + "=" + text;
}

/// A pointer as it stands in front of "=" in an override: with "=" in it, its end would become part of the value.
void check_pointer(const std::string& where, const std::string& pointer, std::vector<Violation>& violations) {
  bool sound = pointer.starts_with('/') && pointer.find('=') == std::string::npos;
  try {
    static_cast<void>(json::json_pointer(pointer));
  } catch (const json::exception&) {
    sound = false;
  }
  if (sound) return;
  violations.push_back({where, '"' + shortened(pointer) + '"',
                        "a JSON pointer into the config, such as /time/dt_s, without \"=\""});
}

void check_pointers(const std::string& where, const json& set, std::vector<Violation>& violations) {
  for (const auto& [pointer, value] : set.items()) check_pointer(where, pointer, violations);
}

/// Every pointer that an axis sets.
std::set<std::string> pointers_of(const json& axis) {
  std::set<std::string> out;
  if (axis.contains("pointer")) out.insert(axis["pointer"].get<std::string>());
  if (!axis.contains("cases")) return out;
  for (const json& one : axis["cases"]) {
    for (const auto& [pointer, value] : one["set"].items()) out.insert(pointer);
  }
  return out;
}

/// Labels, pointers and marks of one axis. where: FILE#/axes/N.
void check_axis(const std::string& where, const json& axis, std::vector<Violation>& violations) {
  std::set<std::string> labels;
  for (std::size_t k = 0; k < entries(axis).size(); ++k) {
    const json& entry = entries(axis)[k];
    const bool is_case = axis.contains("cases");
    const std::string place = fmt::format("{}/{}/{}", where, is_case ? "cases" : "values", k);
    const std::string label =
        is_case ? entry["label"].get<std::string>() : value_label(axis["pointer"].get<std::string>(), entry);
    if (is_case) {
      check_plain_name(place + "/label", label, violations);
      check_pointers(place + "/set", entry["set"], violations);
    }
    if (!labels.insert(label).second) {
      violations.push_back({is_case ? place + "/label" : place, fmt::format("\"{}\" again", shortened(label)),
                            "a label that no other entry of the axis has: records are told apart by it"});
    }
  }
  if (axis.contains("pointer")) {
    check_pointer(where + "/pointer", axis["pointer"].get<std::string>(), violations);
  }
  if (marked_cases(axis).size() > 1) {
    violations.push_back({where, "more than one reference", "one case with reference: true"});
  }
}

/// Everything that the file alone can tell, counted before anything is expanded.
void check_spec(json spec, const std::string& path) {
  std::vector<Violation> violations;
  Rule rule;
  rule.kind = Kind::object;
  rule.list = [](const json&) { return sweep_list(); };
  check_value(spec, rule, path + "#", violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  check_plain_name(path + "#/name", spec["name"].get<std::string>(), violations);
  if (spec.contains("set")) check_pointers(path + "#/set", spec["set"], violations);
  const json& axes = spec["axes"];
  if (const double n = count_cases(axes); n > static_cast<double>(max_sweep_cases)) {
    throw ConfigError(path + "#/axes", fmt::format("{} combinations", n),
                      fmt::format("at most {} cases in one sweep", max_sweep_cases));
  }
  std::map<std::string, std::size_t> axis_of;  // pointer -> the first axis that sets it
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string where = fmt::format("{}#/axes/{}", path, i);
    check_axis(where, axes[i], violations);
    for (const std::string& pointer : pointers_of(axes[i])) {
      if (const auto [earlier, is_new] = axis_of.emplace(pointer, i); !is_new) {
        violations.push_back(
            {where, fmt::format("\"{}\", which axis {} sets too", shortened(pointer), earlier->second),
             "pointers that no other axis sets: the later one would undo the earlier one"});
      }
    }
  }
  if (!violations.empty()) throw ConfigError(std::move(violations));
}

void append_set(const json& set, std::vector<std::string>& overrides) {
  for (const auto& [pointer, value] : set.items()) overrides.push_back(pointer + "=" + value.dump());
}

// The cases so far, each extended by every entry of one axis.
std::vector<SweepCase> extend(const std::vector<SweepCase>& cases, const json& axis) {
  std::vector<SweepCase> out;
  for (const SweepCase& base : cases) {
    const auto add = [&](const std::string& label, const json& set) {
      SweepCase next = base;
      next.label += (next.label.empty() ? "" : " ") + label;
      append_set(set, next.set);
      for (const auto& [pointer, value] : set.items()) next.swept[pointer] = value.dump();
      out.push_back(std::move(next));
    };
    if (axis.contains("pointer")) {
      const auto pointer = axis["pointer"].get<std::string>();
      for (const json& value : axis["values"]) add(value_label(pointer, value), json{{pointer, value}});
    } else {
      for (const json& one : axis["cases"]) add(one["label"].get<std::string>(), one["set"]);
    }
  }
  return out;
}

}  // namespace

SweepSpec parse_sweep(const std::string& text, const std::string& path) {
  SweepSpec out;
  out.text = text;
  const json spec = parse_json(text, path);
  check_spec(spec, path);
  out.name = spec["name"].get<std::string>();
  out.base = spec["base"].get<std::string>();

  SweepCase first;
  if (spec.contains("set")) append_set(spec["set"], first.set);
  out.cases = {first};
  for (const json& axis : spec["axes"]) out.cases = extend(out.cases, axis);
  std::map<std::string, std::size_t> first_of;  // of all axes together: "a b" and "c" as "a" and "b c"
  std::vector<Violation> violations;
  for (std::size_t i = 0; i < out.cases.size(); ++i) {
    if (!first_of.emplace(out.cases[i].label, i).second && violations.empty()) {
      violations.push_back({path + "#/axes", fmt::format("two cases \"{}\"", shortened(out.cases[i].label)),
                            "labels whose combinations differ: records are told apart by them"});
    }
    out.cases[i].reference = marked_reference(spec["axes"], i);
    out.cases[i].group = group_of(spec["axes"], i);
  }
  if (!violations.empty()) throw ConfigError(std::move(violations));
  return out;
}

}  // namespace bb
