// Solids as plain numbers: what a body states of its tetrahedra, and the elements of a scene.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace bb {

/// Tetrahedra of one model, of all bodies that have it.
struct SolidPart {
  std::string model;
  std::vector<std::array<int, 4>> tetrahedra;
  std::vector<double> lame_mu, lame_lambda;  // [n] Pa
};

namespace parts::tetrahedra {

struct Keys {
  std::string solid_model = "corotational";  // "none" for tetrahedra without elements
  double solid_youngs = 1e5;                 // Pa
  double solid_poisson = 0.3;                // 1
  double solid_density = 1000;               // kg/m^3
};

struct Columns {
  std::vector<SolidPart> solids;  // one a model in use, in the order in which bodies bring them
};

}  // namespace parts::tetrahedra
}  // namespace bb
