// Springs of cloth as plain numbers: what a body states of the sides and diagonals of its faces, and the elements of a scene.
#pragma once

#include <array>
#include <vector>

namespace bb {

struct ClothSpringPart {
  std::vector<std::array<int, 2>> pairs;
  std::vector<double> rest_length;                                                 // [n] m
  std::vector<double> tension, tension_growing, compression, compression_growing;  // [n] N/m
  std::vector<double> exponent;                                                    // [n] 1
  std::vector<double> softening;                                                   // [n] m
  std::vector<double> yield, creep;                                                // [n] 1, 1/s
};

namespace parts::cloth_springs {

struct Keys {
  double cloth_tension = 0, cloth_tension_growing = 0;  // N/m, sides of faces that are longer than at rest
  double cloth_compression = 0, cloth_compression_growing = 0;  // N/m, and shorter
  double cloth_shear = 0, cloth_shear_growing = 0;              // N/m, diagonals of faces, either way
  double cloth_skip_one = 0;   // N/m, vertices two apart along a line of a grid, either way
  double cloth_softening = 0;  // m: the length of a spring is sqrt(|d|^2 + softening^2)
  double cloth_exponent = 10;  // 1
  double cloth_yield = 0;      // relative elongation up to which rest lengths stay
  double cloth_creep = 0;      // 1/s; 0: they stay anyway

  bool has_sides() const {
    return cloth_tension > 0 || cloth_tension_growing > 0 || cloth_compression > 0 ||
           cloth_compression_growing > 0;
  }
  bool has_diagonals() const { return cloth_shear > 0 || cloth_shear_growing > 0; }
  bool has_cloth_springs() const { return has_sides() || has_diagonals() || cloth_skip_one > 0; }
};

struct Columns {
  ClothSpringPart cloth_springs;

  const std::vector<std::array<int, 2>>& joined_edges() const { return cloth_springs.pairs; }
};

}  // namespace parts::cloth_springs
}  // namespace bb
