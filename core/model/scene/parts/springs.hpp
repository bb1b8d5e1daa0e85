// Springs as plain numbers: what a body states of its edges, and the elements of a scene.
#pragma once

#include <array>
#include <vector>

namespace bb {

struct SpringPart {
  std::vector<std::array<int, 2>> edges;
  std::vector<double> stiffness;  // [n] N/m
};

namespace parts::springs {

struct Keys {
  double line_density = 0;    // kg/m of lone edges
  double springs = 0;         // N/m, on every unique edge; 0: none
  double rod_stretching = 0;  // N, E A of lone edges; 0: none
};

struct Columns {
  SpringPart springs;

  const std::vector<std::array<int, 2>>& joined_edges() const { return springs.edges; }
};

}  // namespace parts::springs
}  // namespace bb
