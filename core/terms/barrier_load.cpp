#include "core/terms/barrier_load.hpp"

#include <limits>

#include "core/barrier/slope_scan.hpp"

namespace bb {

double LargestSlope::operator()(double d_hat) {
  const auto [at, is_new] = known_.try_emplace(d_hat);
  if (is_new) at->second = max_slope(barrier_, d_hat).value_or(std::numeric_limits<double>::infinity());
  return at->second;
}

double newton_force(const BarrierFunction& barrier, double d, double next, double d_hat) {
  const auto at = barrier.eval(d, d_hat);
  return -at.db + at.d2b * (d - next);
}

}  // namespace bb
