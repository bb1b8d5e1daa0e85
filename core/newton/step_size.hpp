// How long the next step is where the run chooses that itself: by what the last one cost, and by how far it may be from the
// motion in time.
#pragma once

#include <algorithm>
#include <limits>

#include "core/math/types.hpp"

namespace bb {

enum class StepSizeRule { fixed, adaptive };

struct StepSizeOptions {
  StepSizeRule rule = StepSizeRule::fixed;
  int iterations = 6;                                        // of Newton that a step is to take
  int halvings = 4;                                          // a step is at least dt / 2^halvings long
  double error_m = std::numeric_limits<double>::infinity();  // that a step is to make in time
};

/// max_i |x_i - x_0i - h (v_0i + v_i)/2|, m: what a step of length h (s) is away from the trapezoidal rule with its own
/// velocities; of implicit Euler h/2 |v - v_0|, the leading part of its local error. [3 x n] each. Cost: O(n).
double embedded_error(const PositionsView& x0, const PositionsView& v0, const PositionsView& x,
                      const PositionsView& v, double h);

/// The length of the next step, dt / 2^halvings(). Half as long after a step with more than 3/2 of the iterations that are
/// requested, or a larger error; twice as long after one with at most 3/4 of them, so that one of twice the length, whose
/// iterations are twice as many where cloth folds, is no more than requested, and an error of at most a quarter, since it
/// grows with the square. The same steps follow from the same numbers on every machine.
class StepSize {
 public:
  explicit StepSize(const StepSizeOptions& options) : options_(options) {}
  bool adaptive() const { return options_.rule == StepSizeRule::adaptive; }
  int most_halvings() const { return adaptive() ? options_.halvings : 0; }
  bool asks_for_error() const {
    return adaptive() && options_.error_m < std::numeric_limits<double>::infinity();
  }

  /// After a step of dt / 2^halvings that took so many iterations, those of failed attempts among them.
  void took(int halvings, int iterations, double error_m) {
    const bool costly = 2 * iterations > 3 * options_.iterations, rough = error_m > options_.error_m,
               cheap = 4 * iterations <= 3 * options_.iterations, fine = 4 * error_m <= options_.error_m;
    const int change = costly || rough ? 1 : cheap && fine ? -1 : 0;
    halvings_ = std::clamp(halvings + change, 0, options_.halvings);
  }
  int halvings() const { return halvings_; }
  template <class Archive>
  void keep(Archive& archive) {
    archive(halvings_);
  }

 private:
  StepSizeOptions options_;
  int halvings_ = 0;
};

}  // namespace bb
