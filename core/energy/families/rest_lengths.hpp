// Rest lengths of springs whose ends have a rest shape that moves.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/model/scene/moving_rest.hpp"

namespace bb {

class RestLengths {
 public:
  /// start [n] m, at the time 0 without a factor of the time. Pairs outlive it.
  RestLengths(std::span<const std::array<int, 2>> pairs, std::vector<double> start, MovingRest rest);

  std::span<const double> now() const { return now_; }
  /// Becomes the lengths of the time t (s): those of the start times how many times as far as there the two ends are apart at rest.
  /// @return whether now() may have changed   Errors: ConfigError for two ends at one place.
  bool move(double t);

 private:
  std::span<const std::array<int, 2>> pairs_;
  std::vector<double> start_, now_;  // [n] m
  std::vector<double> apart_;        // [n] m, in the rest shape of the start
  MovingRest rest_;
};

}  // namespace bb
