// Rods that bend, as plain numbers: what a body states of its chains of lone edges, and the elements of a scene.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace bb {

/// p0 p1 p2 of each vertex p1 between two lone edges.
struct RodPart {
  std::vector<std::array<int, 3>> corners;
  std::vector<double> stiffness, rest_angle;  // [n] J, rad
  std::vector<char> straight;                 // [n] the rest angle is 0 whatever the rest shape is
};

namespace parts::rods {

enum class RestAngle { shape, straight };

inline std::vector<std::pair<RestAngle, std::string>> words_of(RestAngle) {
  return {{RestAngle::shape, "shape"}, {RestAngle::straight, "straight"}};
}

struct Keys {
  double rod_bending = 0;           // N m^2, E I; an element has it over its length
  double rod_bending_per_mass = 0;  // J/kg; an element has it times its mass, beside what rod_bending gives
  RestAngle rod_rest = RestAngle::shape;

  bool rods_bend() const { return rod_bending > 0 || rod_bending_per_mass > 0; }
};

struct Columns {
  RodPart rods;
};

}  // namespace parts::rods
}  // namespace bb
