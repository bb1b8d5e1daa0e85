#include "core/base/parameters/parameter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/base/parameters/check.hpp"
#include "core/base/parameters/units.hpp"

namespace bb {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

Rule of_kind(Kind kind, std::string unit = "") {
  Rule rule;
  rule.kind = kind;
  rule.unit = std::move(unit);
  return rule;
}

/// Large bounds of numbers as powers of ten.
std::string bound_text(const Rule& rule, double bound) {
  const bool large = rule.kind != Kind::integer && rule.kind != Kind::integers && std::abs(bound) >= 1e9;
  return large ? fmt::format("{:g}", bound) : fmt::format("{}", bound);
}

std::string range_text(const Rule& rule) {
  std::string out;
  if (rule.low > -inf) out = fmt::format(" {} {}", rule.low_open ? ">" : ">=", bound_text(rule, rule.low));
  if (rule.high < inf) {
    out += fmt::format("{} {} {}", out.empty() ? "" : " and",
                       rule.high_open ? "<" : "<=", bound_text(rule, rule.high));
  }
  return out;
}

std::string size_text(const Rule& rule, const char* what) {
  std::string out;
  if (rule.min_size > 0) out = fmt::format(" of at least {}", rule.min_size);
  if (rule.max_size > 0) out += fmt::format("{} at most {}", out.empty() ? " of" : " and", rule.max_size);
  return out.empty() ? out : out + " " + what;
}

std::string one_of(const Rule& rule) {
  const std::vector<std::string> names = rule.words();
  return names.size() == 1 ? '"' + names.front() + '"' : fmt::format("one of {}", fmt::join(names, ", "));
}

std::string kind_text(const Rule& rule) {
  switch (rule.kind) {
    case Kind::boolean:
      return "true or false";
    case Kind::integer:
      return "an integer" + range_text(rule);
    case Kind::number:
      return rule.least > 0
                 ? fmt::format("0, or a number >= {} and <= {}", rule.least, bound_text(rule, rule.high))
                 : "a number" + range_text(rule);
    case Kind::text:
      return "a string" +
             (rule.min_size == 1 && rule.max_size == 0 ? " that is not empty" : size_text(rule, "bytes"));
    case Kind::word:
      return one_of(rule);
    case Kind::words:
      return "an array" + size_text(rule, "elements") + ", each once and " + one_of(rule);
    case Kind::integers:
      return "an array of integers" + range_text(rule);
    case Kind::numbers:
      return "an array of numbers" + range_text(rule);
    case Kind::texts:
      return "an array of one or more strings, none of them empty";
    case Kind::vector:
      return "an array of 3 numbers";
    case Kind::direction:
      return "an array of 3 numbers, not all 0";
    case Kind::box:
      return "an array of 2 arrays of 3 numbers";
    case Kind::values:
    case Kind::objects:
      return "an array" + size_text(rule, "elements");
    case Kind::object:
      break;
  }
  return "an object";
}

const ParameterValue& value_of(const ParameterMap& parameters, const std::string& name) {
  return parameters.at(name);
}

}  // namespace

Rule any_number(std::string unit) {
  const double most = sizes_of(unit).most;
  return number_in(-most, most, std::move(unit));
}
Rule non_negative(std::string unit) {
  const auto [least, most] = sizes_of(unit);
  Rule rule = number_in(0, most, std::move(unit));
  rule.least = least;
  return rule;
}
Rule positive(std::string unit) {
  const auto [least, most] = sizes_of(unit);
  return number_in(least, most, std::move(unit));
}
Rule number_in(double low, double high, std::string unit) {
  Rule rule = of_kind(Kind::number, std::move(unit));
  rule.low = low;
  rule.high = high;
  return rule;
}
Rule count(std::int64_t low, std::int64_t high) {
  Rule rule = number_in(static_cast<double>(low), static_cast<double>(high), "1");
  rule.kind = Kind::integer;
  return rule;
}
Rule flag() { return of_kind(Kind::boolean); }
Rule word(std::vector<std::string> words, std::map<std::string, std::string> renamed) {
  Rule rule = of_kind(Kind::word);
  rule.renamed = std::move(renamed);
  rule.words = [words = std::move(words)] { return words; };
  return rule;
}
Rule words(std::vector<std::string> words) {
  Rule rule = word(std::move(words));
  rule.kind = Kind::words;
  rule.min_size = 1;
  return rule;
}
Rule any_text() { return of_kind(Kind::text); }
Rule text_up_to(std::size_t bytes) {
  Rule rule = any_text();
  rule.min_size = 1;
  rule.max_size = bytes;
  return rule;
}
Rule texts() {
  Rule rule = text_up_to(0);
  rule.kind = Kind::texts;
  return rule;
}
Rule free_text() {
  Rule rule = any_text();
  rule.several_lines = true;
  return rule;
}
Rule any_vector(std::string unit) {
  Rule rule = any_number(std::move(unit));
  rule.kind = Kind::vector;
  return rule;
}
Rule direction() { return of_kind(Kind::direction); }
Rule name_in(std::function<std::vector<std::string>()> names) {
  Rule rule = of_kind(Kind::word);
  rule.words = std::move(names);
  rule.names = true;
  return rule;
}

Rule open_low(Rule rule) {
  const double least = sizes_of(rule.unit).least;
  if (rule.low == 0 && least > std::numeric_limits<double>::denorm_min()) {
    rule.low = least;
  } else {
    rule.low_open = true;
  }
  return rule;
}
Rule open_high(Rule rule) {
  rule.high_open = true;
  return rule;
}
Rule required(Rule rule) {
  rule.required = true;
  return rule;
}
Rule computed(Rule rule, std::string default_in_words) {
  rule.computed = std::move(default_in_words);
  return rule;
}

std::string allowed_text(const Rule& rule) {
  const std::string out = kind_text(rule) + (rule.or_text.empty() ? "" : ", or " + rule.or_text);
  return rule.unit.empty() || rule.unit == "1" ? out : out + " (" + rule.unit + ")";
}

std::string to_text(const ParameterValue& value) {
  return std::holds_alternative<std::monostate>(value) ? "" : to_json(value).dump();
}

double number(const ParameterMap& parameters, const std::string& name) {
  return std::get<double>(value_of(parameters, name));
}
int integer(const ParameterMap& parameters, const std::string& name) {
  return static_cast<int>(std::get<std::int64_t>(value_of(parameters, name)));
}
bool boolean(const ParameterMap& parameters, const std::string& name) {
  return std::get<bool>(value_of(parameters, name));
}
const std::string& text(const ParameterMap& parameters, const std::string& name) {
  return std::get<std::string>(value_of(parameters, name));
}
std::optional<double> optional_number(const ParameterMap& parameters, const std::string& name) {
  return parameters.contains(name) ? std::optional(number(parameters, name)) : std::nullopt;
}

ParameterMap own_parameters(const std::vector<Parameter>& rows, const ParameterMap& given,
                            const std::string& where) {
  nlohmann::json object = nlohmann::json::object();
  for (const Parameter& row : rows) {
    if (given.contains(row.name)) object[row.name] = to_json(given.at(row.name));
  }
  std::vector<Violation> violations;
  check_object(object, {"", rows, false, {}, ""}, where, violations);
  if (!violations.empty()) throw ConfigError(std::move(violations));
  return to_map(rows, object);
}

}  // namespace bb
