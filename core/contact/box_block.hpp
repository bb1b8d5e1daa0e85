// Eight boxes side by side, one vector per coordinate, so that a box is compared with all eight by six
// comparisons and no branch.
#pragma once

#include <cstddef>
#include <limits>

#include "core/contact/lane_set.hpp"
#include "core/contact/tree_box.hpp"

namespace bb {

/// One box in all lanes: what a block is queried with.
struct AskingBox {
  EightFloats lo[3], hi[3];
};

/// Lanes that were never set hold NaN: they overlap nothing, infinite boxes included.
class BoxBlock {
 public:
  static constexpr std::uint32_t width = 8;

  BoxBlock() {
    for (int c = 0; c < 3; ++c) lo_[c] = hi_[c] = std::numeric_limits<float>::quiet_NaN() - EightFloats{};
  }
  void set(std::size_t k, const TreeBox& box) {
    for (int c = 0; c < 3; ++c) {
      lo_[c][k] = box.lo[c];
      hi_[c][k] = box.hi[c];
    }
  }
  AskingBox asking(std::size_t k) const {
    AskingBox out;
    for (int c = 0; c < 3; ++c) {
      out.lo[c] = lo_[c][k] - EightFloats{};
      out.hi[c] = hi_[c][k] - EightFloats{};
    }
    return out;
  }
  /// The lanes whose box overlaps this one, as TreeBox::overlaps says.
  LaneSet overlaps(const AskingBox& box) const {
    EightInts meet = (lo_[0] <= box.hi[0]) & (box.lo[0] <= hi_[0]);
    meet &= (lo_[1] <= box.hi[1]) & (box.lo[1] <= hi_[1]);
    meet &= (lo_[2] <= box.hi[2]) & (box.lo[2] <= hi_[2]);
    return lanes_of(meet);
  }
  /// The lanes that are proven apart from this box, by what both were grown by (box_gap.hpp); in bvh.cpp, since compilers of kernels know no vectors.
  LaneSet apart(const AskingBox& box, const EightFloats& reach) const;
  /// The box of all lanes that were set.
  TreeBox hull() const {
    TreeBox out;
    for (int c = 0; c < 3; ++c) {
      float lo = out.lo[c], hi = out.hi[c];
      for (std::size_t k = 0; k < width; ++k) {  // NaN is never less and never more
        lo = lo_[c][k] < lo ? lo_[c][k] : lo;
        hi = hi_[c][k] > hi ? hi_[c][k] : hi;
      }
      out.lo[c] = lo;
      out.hi[c] = hi;
    }
    return out;
  }
  /// Half the surface area of all boxes that were set, m^2.
  double half_area() const {
    EightFloats e[3];
    for (int c = 0; c < 3; ++c) e[c] = hi_[c] - lo_[c];
    const EightFloats area = e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
    double sum = 0;
    for (std::size_t k = 0; k < width; ++k) sum += area[k] >= 0 ? static_cast<double>(area[k]) : 0;
    return sum;
  }

 private:
  EightFloats lo_[3], hi_[3];
};

}  // namespace bb
