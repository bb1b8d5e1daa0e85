// How far a stiffness has moved.
#pragma once

#include "core/math/host_device.hpp"

namespace bb {

/// max(a, b) / min(a, b) - 1 of two positive numbers; 0 when one is not. Host-device.
BB_HD inline double relative_change(double a, double b) {
  return a > 0 && b > 0 ? (a < b ? b : a) / (b < a ? b : a) - 1 : 0;
}

}  // namespace bb
