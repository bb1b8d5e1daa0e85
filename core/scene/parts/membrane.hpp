// Membranes as plain numbers: what a body says of its triangles, and the elements of a scene.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

/// Membrane elements of one model, of all bodies that have it. Lame parameters already multiplied by
/// the thickness, N/m.
struct MembranePart {
  std::string model;
  std::vector<std::array<int, 3>> triangles;
  std::vector<double> lame_mu, lame_lambda;  // [n] N/m
  std::vector<Vec3d>
      warp;  // anisotropic models: [n] direction, turned into the triangle's plane at rest; else empty
};

namespace parts::membrane {

struct Keys {
  std::string model = "corotational";  // membrane model; "none" for triangles without elements
  std::optional<Vec3d> warp_axis;      // unit; anisotropic models: warp direction at rest, absent: x
  double youngs = 1e5;                 // Pa when thickness is given, N/m (times thickness) otherwise
  std::optional<double> thickness;     // m
  double poisson = 0.3;                // 1
  double density = 0.2;                // kg/m^2 of triangles

  /// Young's modulus times thickness, N/m.
  double youngs_per_width() const { return youngs * thickness.value_or(1.0); }
};

struct Columns {
  std::vector<MembranePart> membranes;  // one a model in use, in the order in which bodies bring them

  /// Triangles of all membranes, part by part.
  std::vector<std::array<int, 3>> membrane_triangles() const {
    std::vector<std::array<int, 3>> all;
    for (const MembranePart& part : membranes) {
      all.insert(all.end(), part.triangles.begin(), part.triangles.end());
    }
    return all;
  }
  std::vector<std::array<int, 3>> filled_triangles() const { return membrane_triangles(); }
};

}  // namespace parts::membrane
}  // namespace bb
