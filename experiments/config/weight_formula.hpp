// Weights as a formula of the place, evaluated by muparser. Private to experiments/config.
#pragma once

#include <string>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

/// Errors: ConfigError at `where`: a text that muparser cannot read (with its position and token), a name that is not
/// known, an assignment, several values.
void require_weight_formula(const std::string& text, const std::string& where);

/// Its value at each of the positions [3 x n] m, in their order, on one thread.   Errors: those of
/// require_weight_formula, and ConfigError for a value that is not finite or outside of [0, 1], with the vertex and its
/// place.
std::vector<double> formula_weights(const std::string& text, const Positions& start,
                                    const std::string& where);

}  // namespace bb
