// The shapes this program knows: the lines of registry.inc, then what plugins added.
#pragma once

#include <string_view>
#include <vector>

#include "core/barrier/shape.hpp"

namespace bb {

/// All shapes, built-ins first, in the order of registry.inc. Host only.
const std::vector<Shape>& shapes();

/// nullptr when there is none. The pointer is valid until the next register_shape.
const Shape* find_shape(std::string_view name);

/// Errors: ConfigError at `where` with the names allowed and the nearest one.
const Shape& require_shape(std::string_view name, std::string_view where = "shape");

/// Adds a shape of a plugin. Not thread-safe: before the first run only.
/// Errors: ConfigError at `where` when the name is taken.
void register_shape(Shape shape, std::string_view where = "shape");

/// "gap" or "squared_gap". Errors: ConfigError at `where`.
Argument require_argument(std::string_view name, std::string_view where = "argument");

}  // namespace bb
