// The formula of a sample NAME.cu, and its shape in other words.
#pragma once

#include "core/barrier/shape.hpp"

namespace bb::formula_kernel_test {

extern const char* const sample_formula;
extern const double sample_tolerance;    // relative: other words for the same shape
extern const bool sample_calls_library;  // whose functions differ in the last place on a card
Shape sample_shape();

}  // namespace bb::formula_kernel_test
