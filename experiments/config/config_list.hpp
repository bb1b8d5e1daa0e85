// Every setting of a config and of a sweep file, for help and for the JSON Schema.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/parameters/parameter.hpp"

namespace bb {

ParameterList config_list();
ParameterList sweep_list();

/// The JSON Schema of "config" or "sweep", as configs/schema has it. Names of plugins are not in it.
nlohmann::ordered_json schema_document(const std::string& format);

}  // namespace bb
