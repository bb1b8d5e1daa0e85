// Shapes against differences of the function that they are the derivatives of.
#include <algorithm>
#include <cmath>

#include "barriers/shapes/registry.hpp"
#include "core/barrier/shape.hpp"
#include "experiments/validity/block.hpp"

namespace bb {

// Both differences are central, with a step that balances truncation and rounding. Errors are relative to the larger of
// |b'|, |b''| at d and at d/2, and of |b'|/d_hat, since b' vanishes at d_hat and b'' everywhere on a straight line.
void check_shape_derivatives(BlockCheck& check) {
  constexpr double d_hat = 0.01;
  for (const Shape& shape : all_shapes()) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      const BarrierFunction barrier{shape, argument};
      for (const double u : {0.05, 0.2, 0.4, 0.6, 0.8, 0.95}) {
        const double d = u * d_hat, step = 1e-5 * d;
        const ShapeTerms<double> at = barrier.eval(d, d_hat), low = barrier.eval(d - step, d_hat),
                                 high = barrier.eval(d + step, d_hat), near = barrier.eval(d / 2, d_hat);
        const double slope = (high.b - low.b) / (2 * step), curvature = (high.db - low.db) / (2 * step);
        const double most_slope = std::max(std::abs(at.db), std::abs(near.db));
        const double most_curvature =
            std::max(std::abs(at.d2b), std::max(std::abs(near.d2b), most_slope / d_hat));
        const double error =
            std::max(std::abs(at.db - slope) / most_slope, std::abs(at.d2b - curvature) / most_curvature);
        check.judge(error, shape.name + " on " + std::string(to_string(argument)));
      }
    }
  }
}

}  // namespace bb
