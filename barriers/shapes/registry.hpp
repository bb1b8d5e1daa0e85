// The shapes this program knows: the lines of registry.inc, then what plugins added.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/base/parameters/registry.hpp"

namespace bb {

/// All shapes, built-ins first, in the order of registry.inc. Host only.
Registry<Shape>& all_shapes();

/// Every name that a shape can be requested by, for messages and help: those of all_shapes(), then formula:TEXT, then NAME:A
/// for each that has an exponent.
std::vector<std::string> shape_names();

/// A shape by its name, by NAME:A with its exponent A, a number, or by formula:TEXT (barriers/formulas.hpp). Errors:
/// ConfigError at `where` with the names allowed and the nearest one, the exponents allowed, or what is wrong with a
/// formula.
Shape require_shape(std::string_view name, std::string_view where = "shape");

/// The same; nothing where require_shape throws.
std::optional<Shape> find_shape(std::string_view name);

/// Names of the shapes that has_potential() is true of on the argument gap, comma-separated.
std::string shapes_with_potential();

/// "gap" or "squared_gap". Errors: ConfigError at `where`.
Argument require_argument(std::string_view name, std::string_view where = "argument");

}  // namespace bb
