// JSON Schema out of a list.
#include <algorithm>
#include <cmath>

#include "core/base/parameters/check.hpp"

namespace bb {
namespace {

using Json = nlohmann::ordered_json;

/// Whole numbers without ".0".
Json bound(double value) {
  if (value == std::floor(value) && std::abs(value) < 1e16) return static_cast<std::int64_t>(value);
  return value;
}

void put_range(const Rule& rule, Json& out) {
  if (rule.least > 0) out["not"] = {{"exclusiveMinimum", 0}, {"exclusiveMaximum", rule.least}};
  if (std::isfinite(rule.low)) out[rule.low_open ? "exclusiveMinimum" : "minimum"] = bound(rule.low);
  if (std::isfinite(rule.high)) out[rule.high_open ? "exclusiveMaximum" : "maximum"] = bound(rule.high);
}

void put_size(const Rule& rule, const char* low, const char* high, Json& out) {
  if (rule.min_size > 0) out[low] = rule.min_size;
  if (rule.max_size > 0) out[high] = rule.max_size;
}

Json rule_schema(const Rule& rule);

Json array_of(Kind element, const Rule& rule, std::size_t exact) {
  Rule one = rule;
  one.kind = element;
  Json out = {{"type", "array"}};
  if (exact > 0) out["minItems"] = out["maxItems"] = exact;
  if (exact == 0) put_size(rule, "minItems", "maxItems", out);
  out["items"] = rule_schema(one);
  return out;
}

Json rule_schema(const Rule& rule) {
  Json out;
  switch (rule.kind) {
    case Kind::boolean:
      return {{"type", "boolean"}};
    case Kind::integer:
    case Kind::number:
      out["type"] = rule.kind == Kind::integer ? "integer" : "number";
      put_range(rule, out);
      return out;
    case Kind::text:
      out["type"] = "string";
      put_size(rule, "minLength", "maxLength", out);
      out["not"]["pattern"] = rule.several_lines
                                  ? "[\\u0000-\\u0008\\u000B\\u000C\\u000E-\\u001F\\u007F-\\u009F]"
                                  : "[\\u0000-\\u001F\\u007F-\\u009F]";
      return out;
    case Kind::word:
      if (rule.list) break;
      return rule.names ? Json{{"type", "string"}} : Json{{"enum", rule.words()}};
    case Kind::words:
      out = array_of(Kind::word, rule, 0);
      out["uniqueItems"] = true;
      return out;
    case Kind::integers:
      return array_of(Kind::integer, rule, 0);
    case Kind::numbers:
      return array_of(Kind::number, rule, 0);
    case Kind::texts:
      return array_of(Kind::text, rule, 0);
    case Kind::vector:
    case Kind::direction:
      return array_of(Kind::number, rule, 3);
    case Kind::box:
      return array_of(Kind::vector, rule, 2);
    case Kind::values:
      out["type"] = "array";
      put_size(rule, "minItems", "maxItems", out);
      return out;
    case Kind::objects:
      return array_of(Kind::object, rule, 0);
    case Kind::object:
      break;
  }
  out = schema_of(rule.list(nullptr));  // no object: what any of them may hold
  if (!rule.or_text.empty() || rule.kind == Kind::word) out["type"] = {"string", "object"};
  return out;
}

/// "x is there and nothing of the other forms."
Json form_schema(const std::vector<std::vector<std::string>>& forms, std::size_t i) {
  Json others = Json::array();
  for (std::size_t k = 0; k < forms.size(); ++k) {
    for (const std::string& key : forms[k]) {
      const bool own = std::find(forms[i].begin(), forms[i].end(), key) != forms[i].end();
      const Json one = {{"required", {key}}};
      if (!own && std::find(others.begin(), others.end(), one) == others.end()) others.push_back(one);
    }
  }
  return {{"required", forms[i]}, {"not", {{"anyOf", others}}}};
}

std::string description(const Parameter& row) {
  if (row.rule.computed.empty()) return row.doc;
  return row.doc + (row.doc.empty() ? "" : " ") + "Default: " + row.rule.computed + ".";
}

}  // namespace

nlohmann::ordered_json schema_of(const ParameterList& list) {
  Json out;
  if (!list.doc.empty()) out["description"] = list.doc;
  out["type"] = "object";
  Json required = Json::array(), properties = Json::object();
  for (const Parameter& row : list.rows) {
    if (row.rule.required) required.push_back(row.name);
    Json one;
    if (const std::string doc = description(row); !doc.empty()) one["description"] = doc;
    const Json keywords = rule_schema(row.rule);
    for (const auto& [key, value] : keywords.items()) {
      if (!one.contains(key)) one[key] = value;
    }
    const nlohmann::json fallback = to_json(row.fallback);
    if (row.rule.computed.empty() && !fallback.is_null()) one["default"] = Json(fallback);
    if (!row.rule.unit.empty()) one["unit"] = row.rule.unit;
    properties[row.name] = std::move(one);
  }
  if (!required.empty()) out["required"] = required;
  if (!list.open) out["additionalProperties"] = false;
  out["properties"] = std::move(properties);
  for (std::size_t i = 0; i < list.forms.size(); ++i) out["oneOf"].push_back(form_schema(list.forms, i));
  return out;
}

}  // namespace bb
