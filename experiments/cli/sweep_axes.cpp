#include "experiments/cli/sweep_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/input/json.hpp"
#include "core/base/input/names.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// KEY=VALUE. What a folder name cannot hold (paths) is replaced.
std::string value_label(const std::string& pointer, const json& value) {
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  for (char& c : text) {
    if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  }
  for (std::size_t at; (at = text.find("..")) != std::string::npos;) text.replace(at, 2, "_");
  return pointer.substr(pointer.rfind('/') + 1) + "=" + text;
}

/// A whole number as an integer, which settings that count require.
json as_json(double value) {
  if (value == std::floor(value) && std::abs(value) < 0x1p53) return static_cast<std::int64_t>(value);
  return value;
}

/// Value i of n between the ends, which are exact; those between have 12 significant digits, so that decades are decades.
double range_value(double from, double to, bool log, std::size_t i, std::size_t n) {
  if (i == 0) return from;
  if (i + 1 == n) return to;
  const double s = static_cast<double>(i) / static_cast<double>(n - 1);
  const double value =
      log ? std::copysign(std::exp(std::log(std::abs(from)) * (1 - s) + std::log(std::abs(to)) * s), from)
          : from * (1 - s) + to * s;
  return std::stod(fmt::format("{:.12g}", value));
}

std::vector<json> range_values(const std::string& where, const json& range,
                               std::vector<Violation>& violations) {
  const double from = range["from"].get<double>(), to = range["to"].get<double>();
  const bool log = range.value("scale", "linear") == "log";
  const auto n = range["count"].get<std::size_t>();
  if (from == to) {
    violations.push_back({where + "/to", json(to).dump(), "another number than `from`"});
  } else if (log && !(from * to > 0)) {
    violations.push_back({where, fmt::format("from {:g} to {:g}", from, to),
                          "two numbers of one sign, neither of them 0: scale log"});
  } else {
    std::vector<json> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(as_json(range_value(from, to, log, i, n)));
    return out;
  }
  return {};
}

Axis values_axis(const std::string& where, const json& axis, std::vector<Violation>& violations) {
  const auto pointer = axis["pointer"].get<std::string>();
  check_pointer(where + "/pointer", pointer, violations);
  const auto values = axis.contains("range") ? range_values(where + "/range", axis["range"], violations)
                                             : axis["values"].get<std::vector<json>>();
  Axis out;
  for (const json& value : values) out.push_back({value_label(pointer, value), {{pointer, value}}, false});
  return out;
}

Axis cases_axis(const std::string& where, const json& axis, std::vector<Violation>& violations) {
  Axis out;
  for (std::size_t k = 0; k < axis["cases"].size(); ++k) {
    const json& one = axis["cases"][k];
    const std::string place = fmt::format("{}/cases/{}", where, k);
    out.push_back({one["label"].get<std::string>(), one["set"], one.value("reference", false)});
    check_plain_name(place + "/label", out.back().label, violations);
    check_pointers(place + "/set", one["set"], violations);
  }
  return out;
}

Axis one_axis(const std::string& where, const json& axis, std::vector<Violation>& violations);

/// Entry k of every axis together.
Axis zipped_axis(const std::string& where, const json& zip, std::vector<Violation>& violations) {
  Axis out = one_axis(where + "/0", zip[0], violations);
  std::set<std::string> earlier = pointers_of(out);
  for (std::size_t a = 1; a < zip.size(); ++a) {
    const std::string place = fmt::format("{}/{}", where, a);
    if (count_entries(zip[a]) != count_entries(zip[0])) {
      violations.push_back(
          {place, fmt::format("{} entries", count_entries(zip[a])),
           fmt::format("{}, as many as the first of the zipped axes has", count_entries(zip[0]))});
      continue;
    }
    const Axis next = one_axis(place, zip[a], violations);
    for (const std::string& pointer : pointers_of(next)) {
      if (earlier.insert(pointer).second) continue;
      violations.push_back({place, fmt::format("\"{}\" again", shortened(pointer)),
                            "a pointer that no other of the zipped axes sets"});
    }
    for (std::size_t k = 0; k < std::min(out.size(), next.size()); ++k) {
      out[k].label += " " + next[k].label;
      out[k].set.update(next[k].set);
      out[k].reference = out[k].reference || next[k].reference;
    }
  }
  return out;
}

Axis one_axis(const std::string& where, const json& axis, std::vector<Violation>& violations) {
  if (axis.contains("zip")) return zipped_axis(where + "/zip", axis["zip"], violations);
  return axis.contains("cases") ? cases_axis(where, axis, violations) : values_axis(where, axis, violations);
}

/// Where entry k of an axis stands.
std::string place_of_entry(const std::string& where, const json& axis, std::size_t k) {
  if (axis.contains("cases")) return fmt::format("{}/cases/{}/label", where, k);
  return axis.contains("values") ? fmt::format("{}/values/{}", where, k) : where;
}

}  // namespace

std::size_t count_entries(const json& axis) {
  if (axis.contains("zip")) return count_entries(axis["zip"][0]);
  if (axis.contains("range")) return axis["range"]["count"].get<std::size_t>();
  return axis.contains("cases") ? axis["cases"].size() : axis["values"].size();
}

Axis expand_axis(const std::string& where, const json& axis, std::vector<Violation>& violations) {
  Axis out = one_axis(where, axis, violations);
  std::set<std::string> labels;
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (labels.insert(out[k].label).second) continue;
    violations.push_back({place_of_entry(where, axis, k),
                          fmt::format("\"{}\" again", shortened(out[k].label)),
                          "a label that no other entry of the axis has: records are distinguished by it"});
  }
  if (std::count_if(out.begin(), out.end(), [](const AxisEntry& entry) { return entry.reference; }) > 1) {
    violations.push_back({where, "more than one reference", "one case with reference: true"});
  }
  return out;
}

std::set<std::string> pointers_of(const Axis& axis) {
  std::set<std::string> out;
  for (const AxisEntry& entry : axis) {
    for (const auto& [pointer, value] : entry.set.items()) out.insert(pointer);
  }
  return out;
}

bool changes_formulation(const Axis& axis) {
  for (const std::string& pointer : pointers_of(axis)) {
    for (const char* section : {"/method", "/formulation", "/strain_limit", "/matching"}) {
      if (pointer == section || pointer.starts_with(std::string(section) + "/")) return true;
    }
  }
  return false;
}

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

}  // namespace bb
