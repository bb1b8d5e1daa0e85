// From double to float, outward: what a float box holds is never less than what it was made from.
#pragma once

#include <cmath>

namespace bb {

/// The largest float that is at most x and the smallest that is at least x, or a neighbour of those.
inline float float_below(double x) { return static_cast<float>(x - (std::abs(x) * 0x1p-23 + 0x1p-140)); }
inline float float_above(double x) { return -float_below(-x); }

}  // namespace bb
