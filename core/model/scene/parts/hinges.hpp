// Bending hinges as plain numbers: what a body states of its interior edges, and the elements of a scene.
#pragma once

#include <array>
#include <vector>

namespace bb {

/// e0 e1 v0 v1 of each interior edge.
struct HingePart {
  std::vector<std::array<int, 4>> hinges;
  std::vector<double> stiffness, rest_angle;  // [n] J, rad
  std::vector<double> exponential, exponent;  // [n] J, 1/rad; empty: no exponential part
  std::vector<double> yield, creep;           // [n] rad, 1/s; empty: rest angles stay
};

namespace parts::hinges {

struct Keys {
  double bending = 0;              // J, stiffness of every hinge; 0: none
  double bending_exponential = 0;  // J, at rest, of a part that grows exponentially
  double bending_exponent = 2;     // 1/rad
  double bending_yield = 0;        // rad, deviation up to which rest angles stay
  double bending_creep = 0;        // 1/s; 0: they stay anyway

  bool hinges_bend() const { return bending > 0 || bending_exponential > 0; }
};

struct Columns {
  HingePart hinges;
};

}  // namespace parts::hinges
}  // namespace bb
