// The kernel that shows that a card computes.
#pragma once

#include <cmath>

#include "core/exec/kernel.hpp"

namespace bb::cuda {

/// A square root and a division in double precision, and an atomic.
struct SelfTest {
  double* out;
  exec::Key* least;
  BB_HD void operator()(exec::Index i) const {
    out[i] = sqrt(2.0 + static_cast<double>(i)) / 3.0;
    exec::atomic_min(least, exec::ordered_bits(out[i]));
  }
};

}  // namespace bb::cuda
