#include "experiments/config/mesh_generators.hpp"

#include "core/mesh/generators.hpp"

namespace bb {

const std::vector<MeshGenerator>& mesh_generators() {
  static const std::vector<MeshGenerator> list = {
      {"grid",
       "rectangle in the x-y plane, every quad split along the same diagonal",
       {count("n_x", 10, 2, 20000, "vertices along x"), count("n_y", 10, 2, 20000, "vertices along y"),
        positive("size_x_m", "m", 1, "size along x"), positive("size_y_m", "m", 1, "size along y")},
       [](const ParameterMap& p) {
         return grid_mesh(integer(p, "n_x"), integer(p, "n_y"), number(p, "size_x_m"), number(p, "size_y_m"));
       }},
      {"icosphere",
       "subdivided icosahedron",
       {count("level", 2, 0, 8, "subdivisions"), positive("radius_m", "m", 0.5, "radius")},
       [](const ParameterMap& p) { return icosphere_mesh(integer(p, "level"), number(p, "radius_m")); }},
      {"cylinder",
       "axis z, with or without caps",
       {count("n_around", 16, 3, 20000, "quads around"), count("n_along", 8, 1, 20000, "quads along"),
        positive("radius_m", "m", 0.5, "radius"), positive("length_m", "m", 1, "length"),
        flag("closed", true, "with caps")},
       [](const ParameterMap& p) {
         return cylinder_mesh(integer(p, "n_around"), integer(p, "n_along"), number(p, "radius_m"),
                              number(p, "length_m"), boolean(p, "closed"));
       }},
      {"box",
       "axis-aligned box",
       {count("n", 1, 1, 1000, "quads along each edge"), positive("size_x_m", "m", 1, "size along x"),
        positive("size_y_m", "m", 1, "size along y"), positive("size_z_m", "m", 1, "size along z")},
       [](const ParameterMap& p) {
         return box_mesh(integer(p, "n"),
                         Vec3d(number(p, "size_x_m"), number(p, "size_y_m"), number(p, "size_z_m")));
       }},
      {"rod",
       "straight rod of lone edges along x",
       {count("n_segments", 10, 1, 20000, "segments"), positive("length_m", "m", 1, "length")},
       [](const ParameterMap& p) {
         const double half = 0.5 * number(p, "length_m");
         return rod_mesh(integer(p, "n_segments"), Vec3d(-half, 0, 0), Vec3d(half, 0, 0));
       }},
  };
  return list;
}

}  // namespace bb
