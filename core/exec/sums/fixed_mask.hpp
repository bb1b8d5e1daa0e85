// Which degrees of freedom of a vertex are prescribed or locked.
#pragma once

#include <cstdint>

#include "core/math/host_device.hpp"

namespace bb::exec {

/// Bit c for coordinate c; vectors are 0 there.
using FixedMask = std::uint8_t;
BB_HD inline bool is_fixed(FixedMask mask, int coordinate) { return (mask >> coordinate & 1) != 0; }

}  // namespace bb::exec
