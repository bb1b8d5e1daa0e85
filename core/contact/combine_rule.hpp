// One coefficient of a contact from those of its two sides.
#pragma once

#include "core/math/host_device.hpp"

namespace bb {

/// How the coefficients of two sides make that of their contact.
enum class CombineRule { min, max, mean };

BB_HD inline double combined(CombineRule rule, double a, double b) {
  if (rule == CombineRule::mean) return (a + b) / 2;
  if (rule == CombineRule::min) return b < a ? b : a;
  return a < b ? b : a;
}

}  // namespace bb
