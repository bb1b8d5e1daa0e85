// Shapes that a config gives as formulas (docs/design.md, Formulas). The Python of analysis/formula reads, checks and
// compiles them into plugins; this file asks it, loads what it made and keeps it for the process.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/parameters/parameter.hpp"

namespace bb {

/// What a shape's name begins with when the rest of it is a formula.
inline constexpr std::string_view formula_prefix = "formula:";

struct FormulaShape {
  Shape shape;          // its name is formula_prefix and the one spelling of the formula
  std::string label;    // formula-HASH, for folders and legends
  std::string library;  // that was compiled and loaded
  std::string sha256;   // of the library
};

bool is_formula(std::string_view shape_name);

/// The shape of a formula such as -(d - d_hat)^2*log(d/d_hat). Two texts with the same tree are one shape.
/// @param at_zero  what it is declared to be: "infinite", "finite", or nothing
/// Errors: ConfigError at `where`: the formula is none, or no barrier (with the gap where it fails), no Python
/// environment, no compiler. Cost: tenths of a second, once a process; seconds where it was never compiled.
/// From any thread.
FormulaShape require_formula(std::string_view text, const std::optional<std::string>& at_zero,
                             std::string_view where);

/// A registered name, or an object {"formula", "at_zero"}.
Rule shape_rule();

/// The formulas among these shapes, each once, asked for before.
std::vector<FormulaShape> formulas_of(const std::vector<std::string>& shape_names);

}  // namespace bb
