// The force law |b'| of a barrier over its whole support: where it peaks, and how large it gets. Generic over
// BarrierFunction: no formula of a shape is written here. Host only, cold paths.
#pragma once

#include <optional>
#include <vector>

#include "core/barrier/shape.hpp"

namespace bb {

/// A gap (m) with the slope |b'| (m) and the curvature b'' there, for kappa = 1.
struct SlopeSample {
  double d, slope, d2b;
};
SlopeSample slope_sample(const BarrierFunction& barrier, double d, double d_hat);

/// Halves [near, far] (far < near) down to adjacent doubles, keeping `beyond` false at near and true at far.
template <class Predicate>
void bisect_slope(const BarrierFunction& barrier, double d_hat, SlopeSample& near, SlopeSample& far,
                  Predicate beyond) {
  for (;;) {
    const double middle = far.d + (near.d - far.d) / 2;
    if (middle <= far.d || middle >= near.d) return;
    const SlopeSample s = slope_sample(barrier, middle, d_hat);
    (beyond(s) ? far : near) = s;
  }
}

/// Samples from d_hat down to 0, or to where |b'| is not finite, with the points where it peaks (b'' changes
/// sign) put in at full precision. Requires d_hat > 0. Cost: about 1,400 evaluations of the shape.
std::vector<SlopeSample> scan_slope(const BarrierFunction& barrier, double d_hat);

/// sup over (0, d_hat) of |b'| in m, including the limit at 0; absent when unbounded.
/// Requires d_hat > 0. Cost: that of a scan.
std::optional<double> max_slope(const BarrierFunction& barrier, double d_hat);
/// The same of a scan.
std::optional<double> max_slope(const BarrierFunction& barrier, const std::vector<SlopeSample>& scan);

}  // namespace bb
