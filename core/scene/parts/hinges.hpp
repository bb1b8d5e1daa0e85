// Bending hinges as plain numbers: what a body says of its interior edges, and the elements of a scene.
#pragma once

#include <array>
#include <vector>

namespace bb {

/// e0 e1 v0 v1 of each interior edge.
struct HingePart {
  std::vector<std::array<int, 4>> hinges;
  std::vector<double> stiffness, rest_angle;  // [n] J, rad
};

namespace parts::hinges {

struct Keys {
  double bending = 0;  // J, stiffness of every hinge; 0: none
};

struct Columns {
  HingePart hinges;
};

}  // namespace parts::hinges
}  // namespace bb
