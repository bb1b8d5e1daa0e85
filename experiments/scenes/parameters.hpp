// Declared parameters: type, unit, default and range of every number a scene or a mesh generator takes, so
// that configs, schema, `list` and `explain` all read the same table.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;
using ParameterMap = std::map<std::string, ParameterValue>;

/// One row of a table; the type is that of the default.
struct Parameter {
  std::string name;  // unit in the suffix, as everywhere in configs
  std::string unit;  // "m", "1", ...; empty for words and booleans
  std::string doc;
  ParameterValue fallback;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;           // low itself is not allowed
  std::vector<std::string> words;  // allowed words of a string parameter
};

/// Rows of the usual kinds.
Parameter positive(std::string name, std::string unit, double fallback, std::string doc);
Parameter non_negative(std::string name, std::string unit, double fallback, std::string doc);
Parameter number_in(std::string name, std::string unit, double fallback, double low, double high,
                    std::string doc);
Parameter any_number(std::string name, std::string unit, double fallback, std::string doc);
Parameter count(std::string name, std::int64_t fallback, std::int64_t low, std::int64_t high,
                std::string doc);
Parameter word(std::string name, std::vector<std::string> words, std::string doc);  // default: the first
Parameter flag(std::string name, bool fallback, std::string doc);

/// "boolean", "integer", "number" or "string".
std::string type_name(const ParameterValue& value);
/// The value as it would stand in JSON.
std::string to_text(const ParameterValue& value);
/// "a number > 0 (m)", "one of a, b", ...
std::string allowed_text(const Parameter& parameter);

/// The given values, checked, with every default filled in. Whole numbers are taken where a number is due.
/// Violations are appended at where + "/" + name: unknown name (nearest suggested), wrong type, out of range.
ParameterMap complete_parameters(const std::vector<Parameter>& table, const ParameterMap& given,
                                 const std::string& where, std::vector<Violation>& violations);

/// Typed reading of a complete map. Precondition: the parameter is declared with that type.
double number(const ParameterMap& parameters, const std::string& name);
int integer(const ParameterMap& parameters, const std::string& name);
bool boolean(const ParameterMap& parameters, const std::string& name);
const std::string& text(const ParameterMap& parameters, const std::string& name);

}  // namespace bb
