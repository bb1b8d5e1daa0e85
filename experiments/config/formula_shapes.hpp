// Formulas in the place of a shape's name. Private to experiments/config.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// `shape` of a section becomes the one name of its formula, whether an object or a name stood there; other shapes stay.
/// What is no barrier is a violation at where/shape, and taken out. The section has been checked by its rows.
void name_formula(nlohmann::json& section, const std::string& where, std::vector<Violation>& violations);

}  // namespace bb
