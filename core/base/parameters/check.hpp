// JSON against lists of parameters: checks, and values out of it and into it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/math/error.hpp"

namespace bb {

/// Appends every violation: unknown key (nearest suggested), wrong kind, out of range, missing; where/KEY,
/// the value found, what is allowed. What is wrong is removed, so that the rest can be read; a word of before becomes
/// the one of now.
void check_object(nlohmann::json& object, const ParameterList& list, const std::string& where,
                  std::vector<Violation>& violations);

/// The same for one value; false: it has to be removed.
bool check_value(nlohmann::json& value, const Rule& rule, const std::string& where,
                 std::vector<Violation>& violations);

/// Finite, within the rule's bounds, and 0 or not too small.
bool in_range(const Rule& rule, double value);

/// The rows' values in a checked object, with their defaults; without rows that are neither given nor have
/// a default.
ParameterMap to_map(const std::vector<Parameter>& rows, const nlohmann::json& object);
/// One value of a checked object; whole numbers are taken where a number is due.
ParameterValue to_value(const Rule& rule, const nlohmann::json& value);

nlohmann::json to_json(const ParameterValue& value);
nlohmann::json to_json(const ParameterMap& parameters);

/// JSON Schema (draft 7) of a list.
nlohmann::ordered_json schema_of(const ParameterList& list);

}  // namespace bb
