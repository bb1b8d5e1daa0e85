// The logarithmic barrier.
#include "barriers/shapes/registry.hpp"
#include "tests/standin/formula_shapes/sample.hpp"

namespace bb::formula_kernel_test {

const char* const sample_formula = "-(d - d_hat)^2*log(d/d_hat)";
const double sample_tolerance = 1e-13;
const bool sample_calls_library = false;
Shape sample_shape() { return require_shape("log"); }

}  // namespace bb::formula_kernel_test
