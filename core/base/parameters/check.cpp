#include "core/base/parameters/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/base/input/names.hpp"
#include "core/base/parameters/registry.hpp"

namespace bb {
namespace {

using nlohmann::json;

bool report(const json& found, const std::string& allowed, const std::string& where,
            std::vector<Violation>& violations) {
  violations.push_back({where, shortened(found.dump()), allowed});
  return false;
}

bool size_fits(const Rule& rule, std::size_t size) {
  return size >= rule.min_size && (rule.max_size == 0 || size <= rule.max_size);
}

/// Whether it is one of the words; NAME:A and NAME:TEXT stand for NAME with anything behind the colon, which whoever
/// takes the word judges.
bool is_word(const std::string& found, const std::vector<std::string>& words) {
  const auto holds = [&words](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  const std::size_t colon = found.find(':');
  return holds(found) || (colon != std::string::npos &&
                          (holds(found.substr(0, colon) + ":A") || holds(found.substr(0, colon) + ":TEXT")));
}

bool check_word(json& value, const Rule& rule, const std::string& where, std::vector<Violation>& violations) {
  const std::vector<std::string> words = rule.words();
  if (value.is_string()) {
    if (const auto now = rule.renamed.find(value.get<std::string>()); now != rule.renamed.end())
      value = now->second;
  }
  const std::string found = value.is_string() ? value.get<std::string>() : "";
  if (value.is_string() && is_word(found, words)) return true;
  Rule alone = rule;
  alone.kind = Kind::word;
  return report(value, words.size() > 1 ? one_of_text(found, words) : allowed_text(alone), where, violations);
}

bool check_text(const json& value, const Rule& rule, const std::string& where,
                std::vector<Violation>& violations) {
  const auto* text = value.get_ptr<const std::string*>();
  if (text == nullptr || !size_fits(rule, text->size())) {
    return report(value, allowed_text(rule), where, violations);
  }
  std::string rest = *text;
  if (rule.several_lines) std::erase_if(rest, [](char c) { return c == '\n' || c == '\r' || c == '\t'; });
  const char* but = rule.several_lines ? " but line ends and tabs" : "";
  return !has_control_character(rest) ||
         report(value, allowed_text(rule) + ", without control characters" + but, where, violations);
}

/// Every element by the same rule; what is wrong is named by its index.
bool check_elements(json& array, const Rule& element, const std::string& where,
                    std::vector<Violation>& violations) {
  bool right = true;
  for (std::size_t i = 0; i < array.size(); ++i) {
    right = check_value(array[i], element, fmt::format("{}/{}", where, i), violations) && right;
  }
  return right;
}

bool check_array(json& value, const Rule& rule, const std::string& where,
                 std::vector<Violation>& violations) {
  const bool three = rule.kind == Kind::vector || rule.kind == Kind::direction;
  const std::size_t exact = three ? 3 : rule.kind == Kind::box ? 2 : 0;
  const bool fits =
      value.is_array() && size_fits(rule, value.size()) && (exact == 0 || value.size() == exact);
  if (!fits) return report(value, allowed_text(rule), where, violations);
  if (rule.kind == Kind::values) return true;
  Rule element = rule;
  element.kind = rule.kind == Kind::words      ? Kind::word
                 : rule.kind == Kind::integers ? Kind::integer
                 : rule.kind == Kind::texts    ? Kind::text
                 : rule.kind == Kind::box      ? Kind::vector
                 : rule.kind == Kind::objects  ? Kind::object
                                               : Kind::number;
  if (!check_elements(value, element, where, violations)) return false;
  const bool zero = rule.kind == Kind::direction &&
                    std::all_of(value.begin(), value.end(), [](const json& v) { return v == 0; });
  const bool twice =
      rule.kind == Kind::words && std::set<json>(value.begin(), value.end()).size() < value.size();
  return !zero && !twice ? true : report(value, allowed_text(rule), where, violations);
}

/// Whether the keys make up one of the forms, and nothing that is of other forms alone. Forms may share keys.
bool has_form(const json& object, const ParameterList& list) {
  const auto is_there = [&](const std::string& key) { return object.contains(key); };
  std::set<std::string> given;
  for (const std::vector<std::string>& form : list.forms) {
    std::copy_if(form.begin(), form.end(), std::inserter(given, given.end()), is_there);
  }
  const auto is_it = [&](const std::vector<std::string>& form) {
    return given == std::set<std::string>(form.begin(), form.end());
  };
  return list.forms.empty() || std::any_of(list.forms.begin(), list.forms.end(), is_it);
}

std::string keys_text(const json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return shortened(
      fmt::format("an object with {}", keys.empty() ? "nothing" : fmt::to_string(fmt::join(keys, ", "))));
}

}  // namespace

bool in_range(const Rule& rule, double value) {
  if (value != 0 && std::abs(value) < rule.least) return false;
  return std::isfinite(value) && (rule.low_open ? value > rule.low : value >= rule.low) &&
         (rule.high_open ? value < rule.high : value <= rule.high);
}

bool check_value(json& value, const Rule& rule, const std::string& where,
                 std::vector<Violation>& violations) {
  switch (rule.kind) {
    case Kind::boolean:
      return value.is_boolean() || report(value, allowed_text(rule), where, violations);
    case Kind::integer:
      return (value.is_number_integer() && in_range(rule, value.get<double>())) ||
             report(value, allowed_text(rule), where, violations);
    case Kind::number:
      return (value.is_number() && in_range(rule, value.get<double>())) ||
             report(value, allowed_text(rule), where, violations);
    case Kind::text:
      return check_text(value, rule, where, violations);
    case Kind::word:
      if (!rule.list || !value.is_object()) return check_word(value, rule, where, violations);
      check_object(value, rule.list(value), where, violations);
      return true;
    case Kind::object:
      if (!value.is_object()) return report(value, allowed_text(rule), where, violations);
      check_object(value, rule.list(value), where, violations);
      return true;
    default:
      return check_array(value, rule, where, violations);
  }
}

void check_object(json& object, const ParameterList& list, const std::string& where,
                  std::vector<Violation>& violations) {
  const bool formed = has_form(object, list);
  if (!formed) violations.push_back({where, keys_text(object), list.forms_text});
  std::vector<std::string> wrong;
  for (auto& [key, value] : object.items()) {
    const std::string at = where + "/" + shortened(key);
    if (const Parameter* row = find_named(list.rows, key)) {
      if (!check_value(value, row->rule, at, violations)) wrong.push_back(key);
    } else if (!list.open) {
      violations.push_back(
          {at, fmt::format("the unknown key \"{}\"", shortened(key)), one_of_text(key, names_of(list.rows))});
      wrong.push_back(key);
    }
  }
  for (const Parameter& row : list.rows) {
    if (!row.rule.required || object.contains(row.name)) continue;
    violations.push_back({where + "/" + row.name, "nothing", allowed_text(row.rule)});
  }
  for (const std::string& key : wrong) object.erase(key);
}

ParameterValue to_value(const Rule& rule, const json& value) {
  switch (rule.kind) {
    case Kind::boolean:
      return value.get<bool>();
    case Kind::integer:
      return value.get<std::int64_t>();
    case Kind::number:
      return value.get<double>();
    case Kind::words:
    case Kind::texts:
      return value.get<std::vector<std::string>>();
    case Kind::vector:
    case Kind::direction:
    case Kind::integers:
    case Kind::numbers:
      return value.get<std::vector<double>>();
    default:
      return value.get<std::string>();
  }
}

ParameterMap to_map(const std::vector<Parameter>& rows, const json& object) {
  ParameterMap out;
  for (const Parameter& row : rows) {
    const json value = object.contains(row.name) ? object[row.name] : to_json(row.fallback);
    if (!value.is_null()) out[row.name] = to_value(row.rule, value);
  }
  return out;
}

json to_json(const ParameterValue& value) {
  if (std::holds_alternative<std::monostate>(value)) return nullptr;
  json out;
  std::visit(
      [&out](const auto& held) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(held)>, std::monostate>) out = held;
      },
      value);
  return out;
}

json to_json(const ParameterMap& parameters) {
  json out = json::object();
  for (const auto& [name, value] : parameters) out[name] = to_json(value);
  return out;
}

}  // namespace bb
