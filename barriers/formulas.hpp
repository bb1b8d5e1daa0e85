// Shapes and stiffnesses that a config gives as formulas (docs/reference/formulas.md). The Python of analysis/src/barrierbench_analysis/program/formula reads, checks and
// compiles them into plugins; this file calls it, loads what it made and keeps it for the process.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/base/parameters/parameter.hpp"
#include "core/model/plugin/plugin.hpp"

namespace bb {

/// What a shape's name begins with when the rest of it is a formula.
inline constexpr std::string_view formula_prefix = "formula:";

inline constexpr std::size_t most_formula_bytes = 400;  // as grammar.py has it

/// The plugin that was made of a formula.
struct FormulaLibrary {
  std::string name;           // formula_prefix and the one spelling of the formula
  std::string label;          // formula-HASH, for folders and legends
  std::string file;           // that was compiled and loaded
  std::string sha256;         // of the file
  std::string unproven = {};  // of a shape whose signs are only sampled in places: where
};

struct FormulaShape {
  Shape shape;  // its name is that of the library
  FormulaLibrary library;
};

/// kappa (N/m) and d kappa/dd (N/m^2) at n gaps d (m) of a pair, d_hat in m, the others as analysis/src/barrierbench_analysis/program/formula/grammar.py has them.
using FormulaInGap = void (*)(double m, double k, double h, double c, double d_hat, std::size_t n,
                              const double* d, double* kappa, double* slope);

struct FormulaPolicy {
  std::string formula;  // its one spelling
  PluginPolicy policy;
  FormulaLibrary library;
  FormulaInGap in_gap = nullptr;
  bool reads_gap = false;  // kappa depends on d
  double slope_error = 0;  // of d kappa/dd against 40 digits, as a part of kappa/d
};

bool is_formula(std::string_view shape_name);

/// The shape of a formula such as -(d - d_hat)^2*log(d/d_hat). Two texts with the same tree are one shape.
/// @param at_zero  what it is declared to be: "infinite", "finite", or nothing
/// Errors: ConfigError at `where`: the formula is none, or no barrier (with the gap where it fails), no Python
/// environment, no compiler. Cost: tenths of a second, once a process; seconds where it was never compiled.
/// From any thread.
FormulaShape require_formula(std::string_view text, const std::optional<std::string>& at_zero,
                             std::string_view where);

/// A stiffness, kappa in N/m of a contact, such as m/h^2 + k (analysis/src/barrierbench_analysis/program/formula/grammar.py has the symbols). Errors and cost as those
/// of require_formula.
FormulaPolicy require_policy_formula(std::string_view text, std::string_view where);

/// A registered name, or an object {"formula", "at_zero"}.
Rule shape_rule();

/// The libraries of the formulas among these shapes, and of these formulas of policies, each once.
std::vector<FormulaLibrary> formula_libraries(const std::vector<std::string>& shape_names,
                                              const std::vector<std::string>& policies = {});

}  // namespace bb
