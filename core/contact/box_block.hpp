// Eight boxes side by side, one column per coordinate, so that a box is compared with all eight by a few
// vector instructions and no branch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/contact/aabb.hpp"

namespace bb {

/// A set of lanes of a block, bit k for lane k.
using LaneSet = std::uint32_t;

/// Lanes that were never set hold NaN: they overlap nothing, infinite boxes included.
class alignas(64) BoxBlock {
 public:
  static constexpr std::uint32_t width = 8;

  BoxBlock() {
    for (auto* side : {lo_, hi_}) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < width; ++k) side[c][k] = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  void set(std::size_t k, const Aabb& box) {
    for (std::size_t c = 0; c < 3; ++c) {
      lo_[c][k] = box.lo[static_cast<int>(c)];
      hi_[c][k] = box.hi[static_cast<int>(c)];
    }
  }
  Aabb get(std::size_t k) const {
    return {Vec3d(lo_[0][k], lo_[1][k], lo_[2][k]), Vec3d(hi_[0][k], hi_[1][k], hi_[2][k])};
  }
  /// The lanes whose box overlaps lane j of another block, as Aabb::overlaps says.
  LaneSet overlaps(const BoxBlock& other, std::size_t j) const {
    const double lo0 = other.lo_[0][j], lo1 = other.lo_[1][j], lo2 = other.lo_[2][j];
    const double hi0 = other.hi_[0][j], hi1 = other.hi_[1][j], hi2 = other.hi_[2][j];
    LaneSet lanes = 0;
    for (std::size_t k = 0; k < width; ++k) {  // & and not &&: the compiler turns the loop into vectors
      const bool overlap = (lo_[0][k] <= hi0) & (lo0 <= hi_[0][k]) & (lo_[1][k] <= hi1) & (lo1 <= hi_[1][k]) &
                           (lo_[2][k] <= hi2) & (lo2 <= hi_[2][k]);
      lanes |= static_cast<LaneSet>(overlap) << k;
    }
    return lanes;
  }
  /// The box of all lanes that were set.
  Aabb hull() const {
    Aabb out;
    for (std::size_t c = 0; c < 3; ++c) {
      double &lo = out.lo[static_cast<int>(c)], &hi = out.hi[static_cast<int>(c)];
      for (std::size_t k = 0; k < width; ++k) {  // NaN is never less and never more
        lo = lo_[c][k] < lo ? lo_[c][k] : lo;
        hi = hi_[c][k] > hi ? hi_[c][k] : hi;
      }
    }
    return out;
  }

 private:
  double lo_[3][width], hi_[3][width];
};

}  // namespace bb
