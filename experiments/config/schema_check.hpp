// Validation of documents against the schemas of configs and sweeps (configs/schema), which are baked into
// the program. The only place that knows the validator library.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// The texts of the schemas.
const std::string& config_schema();
const std::string& sweep_schema();

/// Appends every violation as source#/pointer, the value found, and what the schema allows there (for unknown
/// keys the nearest known one; for a node with oneOf its annotation "allowed"). What is wrong is removed from
/// the document, so that the rest can be read and checked too.
void check_schema(nlohmann::json& document, const std::string& schema, const std::string& source,
                  std::vector<Violation>& violations);

/// Validates any document against any schema text; messages only. For tests of the configs and records.
std::vector<std::string> validate_json(const std::string& document, const std::string& schema);

}  // namespace bb
