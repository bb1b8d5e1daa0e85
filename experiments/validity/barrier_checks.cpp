// Shapes against differences of the function that they are the derivatives of.
#include <algorithm>
#include <cmath>

#include "barriers/shapes/registry.hpp"
#include "core/barrier/shape.hpp"
#include "experiments/validity/block.hpp"

namespace bb {

// Both differences are central, with a step that balances truncation and rounding; errors are relative to the
// largest |b'|, |b''| of the gaps nearby, since b' vanishes at d_hat.
void check_shape_derivatives(BlockCheck& check) {
  constexpr double d_hat = 0.01;
  for (const Shape& shape : shapes()) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      const BarrierFunction barrier{shape, argument};
      for (const double u : {0.05, 0.2, 0.4, 0.6, 0.8, 0.95}) {
        const double d = u * d_hat, step = 1e-5 * d;
        const ShapeTerms<double> at = barrier.eval(d, d_hat), low = barrier.eval(d - step, d_hat),
                                 high = barrier.eval(d + step, d_hat);
        const double slope = (high.b - low.b) / (2 * step), curvature = (high.db - low.db) / (2 * step);
        const double error = std::max(std::abs(at.db / slope - 1), std::abs(at.d2b / curvature - 1));
        check.judge(error, shape.name + " on " + std::string(to_string(argument)));
      }
    }
  }
}

}  // namespace bb
