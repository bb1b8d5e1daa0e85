// Functions of the library and a power that is no integer, derived by hand. With e = 1 - d/d_hat:
//   b = d_hat^2 f(e),   b' = -d_hat f'(e),   b'' = f''(e),   f = e^2 (exp e + cosh e + atan e) + e^(5/2)
#include <cmath>

#include "barriers/shapes/registry.hpp"
#include "tests/standin/formula_shapes/sample.hpp"

namespace bb::formula_kernel_test {

const char* const sample_formula =
    "(d_hat - d)^2*(exp(1 - d/d_hat) + cosh(1 - d/d_hat) + atan(1 - d/d_hat)) + (d_hat - "
    "d)^(5/2)/d_hat^(1/2)";
const double sample_tolerance = 1e-12;
const bool sample_calls_library = true;

static void evaluate(void*, std::size_t n, const double* d, const double* d_hat, double* b, double* db,
                     double* d2b) {
  for (std::size_t i = 0; i < n; ++i) {
    const double e = d[i] < d_hat[i] ? (d_hat[i] - d[i]) / d_hat[i] : 0, grown = std::exp(e),
                 square = 1 + e * e;
    const double sum = grown + std::cosh(e), slope = grown + std::sinh(e);
    b[i] = d_hat[i] * d_hat[i] * (e * e * (sum + std::atan(e)) + e * e * std::sqrt(e));
    db[i] =
        -d_hat[i] * (2 * e * (sum + std::atan(e)) + e * e * (slope + 1 / square) + 2.5 * e * std::sqrt(e));
    d2b[i] = d[i] >= d_hat[i] ? 0
                              : 2 * (sum + std::atan(e)) + 4 * e * (slope + 1 / square) +
                                    e * e * (sum - 2 * e / (square * square)) + 3.75 * std::sqrt(e);
  }
}

Shape sample_shape() {
  Shape shape = require_shape("quadratic");  // for all but the call
  shape.batch_double = evaluate;
  return shape;
}

}  // namespace bb::formula_kernel_test
