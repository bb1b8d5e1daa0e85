#include "experiments/scenes/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "barriers/named_entries.hpp"

namespace bb {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

bool in_range(const Parameter& p, double value) {
  return std::isfinite(value) && (p.low_open ? value > p.low : value >= p.low) && value <= p.high;
}

/// Converts a whole number where a number is due; false when the type is wrong.
bool convert(const ParameterValue& like, ParameterValue& value) {
  if (std::holds_alternative<double>(like) && std::holds_alternative<std::int64_t>(value)) {
    value = static_cast<double>(std::get<std::int64_t>(value));
  }
  return value.index() == like.index();
}

bool allowed(const Parameter& p, const ParameterValue& value) {
  if (const auto* d = std::get_if<double>(&value)) return in_range(p, *d);
  if (const auto* i = std::get_if<std::int64_t>(&value)) return in_range(p, static_cast<double>(*i));
  if (const auto* s = std::get_if<std::string>(&value)) {
    return std::find(p.words.begin(), p.words.end(), *s) != p.words.end();
  }
  return true;
}

}  // namespace

Parameter positive(std::string name, std::string unit, double fallback, std::string doc) {
  return {std::move(name), std::move(unit), std::move(doc), fallback, 0, inf, true, {}};
}
Parameter non_negative(std::string name, std::string unit, double fallback, std::string doc) {
  return {std::move(name), std::move(unit), std::move(doc), fallback, 0, inf, false, {}};
}
Parameter number_in(std::string name, std::string unit, double fallback, double low, double high,
                    std::string doc) {
  return {std::move(name), std::move(unit), std::move(doc), fallback, low, high, false, {}};
}
Parameter any_number(std::string name, std::string unit, double fallback, std::string doc) {
  return {std::move(name), std::move(unit), std::move(doc), fallback, -inf, inf, false, {}};
}
Parameter count(std::string name, std::int64_t fallback, std::int64_t low, std::int64_t high,
                std::string doc) {
  return {std::move(name), "1", std::move(doc), fallback, static_cast<double>(low), static_cast<double>(high),
          false,           {}};
}
Parameter word(std::string name, std::vector<std::string> words, std::string doc) {
  return {std::move(name), "", std::move(doc), words.front(), -inf, inf, false, words};
}
Parameter flag(std::string name, bool fallback, std::string doc) {
  return {std::move(name), "", std::move(doc), fallback, -inf, inf, false, {}};
}

std::string type_name(const ParameterValue& value) {
  constexpr const char* names[] = {"boolean", "integer", "number", "string"};
  return names[value.index()];
}

std::string to_text(const ParameterValue& value) {
  if (const auto* b = std::get_if<bool>(&value)) return *b ? "true" : "false";
  if (const auto* i = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *i);
  if (const auto* d = std::get_if<double>(&value)) return fmt::format("{}", *d);
  return '"' + std::get<std::string>(value) + '"';
}

std::string allowed_text(const Parameter& p) {
  if (std::holds_alternative<bool>(p.fallback)) return "true or false";
  if (std::holds_alternative<std::string>(p.fallback))
    return fmt::format("one of {}", fmt::join(p.words, ", "));
  std::string out = std::holds_alternative<double>(p.fallback) ? "a number" : "an integer";
  if (p.low > -inf && p.high < inf) {
    out += fmt::format(" {} {} and <= {}", p.low_open ? ">" : ">=", p.low, p.high);
  } else if (p.low > -inf) {
    out += fmt::format(" {} {}", p.low_open ? ">" : ">=", p.low);
  }
  return p.unit.empty() || p.unit == "1" ? out : out + " (" + p.unit + ")";
}

ParameterMap complete_parameters(const std::vector<Parameter>& table, const ParameterMap& given,
                                 const std::string& where, std::vector<Violation>& violations) {
  ParameterMap out;
  for (const Parameter& p : table) out[p.name] = p.fallback;
  for (const auto& [name, found] : given) {
    const Parameter* p = find_entry(table, name);
    if (!p) {
      const ConfigError unknown = unknown_name(where + "/" + name, name, entry_names(table));
      violations.push_back(unknown.violations().front());
      continue;
    }
    ParameterValue value = found;
    if (convert(p->fallback, value) && allowed(*p, value)) {
      out[name] = value;
      continue;
    }
    Violation violation{where + "/" + name, to_text(found), allowed_text(*p)};
    if (const auto* wrong = std::get_if<std::string>(&found)) {
      const std::string nearest = nearest_name(*wrong, p->words);
      if (!nearest.empty()) violation.allowed += " (did you mean " + nearest + "?)";
    }
    violations.push_back(std::move(violation));
  }
  return out;
}

double number(const ParameterMap& parameters, const std::string& name) {
  return std::get<double>(parameters.at(name));
}
int integer(const ParameterMap& parameters, const std::string& name) {
  return static_cast<int>(std::get<std::int64_t>(parameters.at(name)));
}
bool boolean(const ParameterMap& parameters, const std::string& name) {
  return std::get<bool>(parameters.at(name));
}
const std::string& text(const ParameterMap& parameters, const std::string& name) {
  return std::get<std::string>(parameters.at(name));
}

}  // namespace bb
