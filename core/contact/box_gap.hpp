// What two boxes report of the distance of what is in them, beyond whether they overlap: one arithmetic for the CPU's eight
// lanes and for kernels, so that the lists of candidates of both are equal.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// Whether two primitives are proven farther apart than `reach`, the sum of what their boxes [lo, hi] were grown by on
/// every side, m: boxes that overlap near a corner are farther apart than that. F: float, or lanes of it; a number that
/// is none proves nothing.
template <class F>
BB_HD auto apart_by_boxes(const F* lo_a, const F* hi_a, const F* lo_b, const F* hi_b, const F& reach) {
  const F zero = F{};
  F sum = zero;
  for (int c = 0; c < 3; ++c) {
    const F below = hi_a[c] - lo_b[c], above = hi_b[c] - lo_a[c];
    const F overlap = below < above ? below : above, gap = reach - overlap;
    const F positive = gap > zero ? gap : zero;
    sum = sum + positive * positive;
  }
  return sum > reach * reach * (1 + 0x1p-16f);  // a gap is right to three roundings of the reach
}

}  // namespace bb
