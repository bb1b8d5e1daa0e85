#include "core/base/parameters/units.hpp"

#include <limits>

namespace bb {

Sizes sizes_of(std::string_view unit) {
  constexpr Sizes any{1e-36, 1e18};  // a fibre of 1e-24 N m^2, a membrane of a cell of 1e-19 J
  struct OfUnit {
    std::string_view unit;
    Sizes sizes;
  };
  constexpr OfUnit table[] = {
      {"", {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::infinity()}},
      {"m", {1e-15, 1e15}},  // as the coordinates of a mesh (core/model/mesh/bounds.hpp)
      {"s", {1e-18, 1e9}},
      {"m/s", {1e-15, 1e12}},
      {"m/s^2", {1e-15, 1e12}},
      {"deg", {1e-12, 1e9}},
      {"rad", {1e-12, 1e9}},
      {"rad/s", {1e-12, 1e9}},
  };
  for (const OfUnit& one : table) {
    if (one.unit == unit) return one.sizes;
  }
  return any;
}

}  // namespace bb
