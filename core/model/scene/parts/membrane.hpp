// Membranes as plain numbers: what a body states of its triangles, and the elements of a scene.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/math/types.hpp"
#include "core/model/scene/rest_motion.hpp"

namespace bb {

/// Membrane elements of one model, of all bodies that have it. Lame parameters already multiplied by
/// the thickness, N/m.
struct MembranePart {
  std::string model;
  std::vector<std::array<int, 3>> triangles;
  std::vector<double> lame_mu, lame_lambda;  // [n] N/m
  std::vector<Vec3d>
      warp;  // [n] direction, turned into the triangle's plane at rest, of anisotropic models and of shrinkage
             // with a direction; empty: the first edge of each triangle
  std::vector<Vec2d> shrink;         // [n] factors on the rest shape along warp and across; empty: 1
  std::vector<double> yield, creep;  // [n] 1, 1/s; empty: rest shapes stay
};

namespace parts::membrane {

/// How the mass of a triangle is split among its corners (core/model/bodies/lumping.hpp).
enum class Lumping { barycentric, mixed_voronoi, uniform };

inline std::vector<std::pair<Lumping, std::string>> words_of(Lumping) {
  return {{Lumping::barycentric, "barycentric"},
          {Lumping::mixed_voronoi, "mixed_voronoi"},
          {Lumping::uniform, "uniform"}};
}

struct Keys {
  std::string model = "corotational";  // membrane model; "none" for triangles without elements
  std::optional<Vec3d> warp_axis;      // unit; anisotropic models: warp direction at rest, absent: x
  double youngs = 1e5;                 // Pa when thickness is given, N/m (times thickness) otherwise
  std::optional<double> thickness;     // m
  double poisson = 0.3;                // 1
  double shrink_warp = 1;              // factor on rest lengths along the warp direction
  double shrink_weft = 1;              // and at right angles to it
  std::vector<ShrinkKey> shrink_keys;  // a factor on all rest lengths of the body over time; empty: 1
  double membrane_yield = 0;           // |sigma - 1| up to which the rest shape stays
  double membrane_creep = 0;           // 1/s; 0: it stays anyway
  double plasticity = 0;  // share of what is beyond a yield that rest shapes take in plasticity_step
  double plasticity_step = 1.0 / 24;  // s
  double density = 0.2;               // kg/m^2 of triangles
  Lumping lumping = Lumping::barycentric;

  /// Young's modulus times thickness, N/m.
  double youngs_per_width() const { return youngs * thickness.value_or(1.0); }
  bool shrinks() const { return shrink_warp != 1 || shrink_weft != 1; }
  bool shrinks_along_warp() const { return shrink_warp != shrink_weft; }
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
