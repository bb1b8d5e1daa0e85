// Every setting of a config and of a sweep file, for help and for the JSON Schema.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/parameters/parameter.hpp"

namespace bb {

/// Most combinations of the axes of one sweep, and most axes that are zipped.
inline constexpr std::size_t max_sweep_cases = 100000, max_zipped = 64;

ParameterList config_list();
ParameterList sweep_list();

/// The JSON Schema of "config" or "sweep", as configs/schema has it. Names of plugins are not in it.
nlohmann::ordered_json schema_document(const std::string& format);

}  // namespace bb
