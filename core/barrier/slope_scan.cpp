#include "core/barrier/slope_scan.hpp"

#include <algorithm>
#include <cmath>

namespace bb {
namespace {

/// Gaps in units of d_hat from 1 down to 0: a factor of two apart towards both ends, evenly spaced between,
/// so that the scale of any load is met and a hump wider than 1/256 is seen.
std::vector<double> ladder() {
  constexpr int even = 256;
  std::vector<double> u;
  for (int k = 53; k > 8; --k) u.push_back(1 - std::ldexp(1.0, -k));
  for (int i = even - 1; i > 0; --i) u.push_back(static_cast<double>(i) / even);
  for (int k = 9; k <= 1022; ++k) u.push_back(std::ldexp(1.0, -k));
  u.push_back(0);
  return u;
}

}  // namespace

SlopeSample slope_sample(const BarrierFunction& barrier, double d, double d_hat) {
  const ShapeTerms<double> terms = barrier.eval(d, d_hat);
  return {d, std::abs(terms.db), terms.d2b};
}

std::vector<SlopeSample> scan_slope(const BarrierFunction& barrier, double d_hat) {
  std::vector<SlopeSample> samples;
  for (const double u : ladder()) {
    const SlopeSample next = slope_sample(barrier, u * d_hat, d_hat);
    if (!samples.empty()) {
      SlopeSample near = samples.back(), far = next;
      if (near.d2b > 0 && far.d2b <= 0) {
        bisect_slope(barrier, d_hat, near, far, [](const SlopeSample& s) { return s.d2b <= 0; });
        samples.push_back(near.slope > far.slope ? near : far);
      }
    }
    samples.push_back(next);
    if (!std::isfinite(next.slope)) break;
  }
  return samples;
}

std::optional<double> max_slope(const BarrierFunction& barrier, const std::vector<SlopeSample>& scan) {
  // b infinite at 0 over a bounded interval has an unbounded derivative
  if (barrier.shape.infinite_at_zero) return std::nullopt;
  double slope = 0;
  for (const SlopeSample& s : scan) slope = std::max(slope, s.slope);
  if (!std::isfinite(slope)) return std::nullopt;
  return slope;
}

std::optional<double> max_slope(const BarrierFunction& barrier, double d_hat) {
  return max_slope(barrier, scan_slope(barrier, d_hat));
}

}  // namespace bb
