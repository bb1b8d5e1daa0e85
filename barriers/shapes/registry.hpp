// The shapes this program knows: the lines of registry.inc, then what plugins added.
#pragma once

#include <string>
#include <string_view>

#include "core/barrier/shape.hpp"
#include "core/parameters/registry.hpp"

namespace bb {

/// All shapes, built-ins first, in the order of registry.inc. Host only.
Registry<Shape>& shapes();

/// Errors: ConfigError at `where` with the names allowed and the nearest one.
const Shape& require_shape(std::string_view name, std::string_view where = "shape");

/// Names of the shapes that has_potential() is true of on the argument gap, comma-separated.
std::string shapes_with_potential();

/// "gap" or "squared_gap". Errors: ConfigError at `where`.
Argument require_argument(std::string_view name, std::string_view where = "argument");

}  // namespace bb
