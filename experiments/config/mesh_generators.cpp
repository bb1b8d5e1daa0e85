#include "experiments/config/mesh_generators.hpp"

#include "core/mesh/generators.hpp"
#include "core/mesh/solid_generators.hpp"

namespace bb {

const Registry<MeshGenerator>& mesh_generators() {
  static const Registry<MeshGenerator> list({
      {"grid",
       "rectangle in the x-y plane, every quad split along the same diagonal",
       {{"n_x", count(2, 20000), 10, "vertices along x"},
        {"n_y", count(2, 20000), 10, "vertices along y"},
        {"size_x_m", positive("m"), 1, "size along x"},
        {"size_y_m", positive("m"), 1, "size along y"}},
       [](const ParameterMap& p) {
         return grid_mesh(integer(p, "n_x"), integer(p, "n_y"), number(p, "size_x_m"), number(p, "size_y_m"));
       }},
      {"icosphere",
       "subdivided icosahedron",
       {{"level", count(0, 8), 2, "subdivisions"}, {"radius_m", positive("m"), 0.5, "radius"}},
       [](const ParameterMap& p) { return icosphere_mesh(integer(p, "level"), number(p, "radius_m")); }},
      {"cylinder",
       "axis z, with or without caps",
       {{"n_around", count(3, 20000), 16, "quads around"},
        {"n_along", count(1, 20000), 8, "quads along"},
        {"radius_m", positive("m"), 0.5, "radius"},
        {"length_m", positive("m"), 1, "length"},
        {"closed", flag(), true, "with caps"}},
       [](const ParameterMap& p) {
         return cylinder_mesh(integer(p, "n_around"), integer(p, "n_along"), number(p, "radius_m"),
                              number(p, "length_m"), boolean(p, "closed"));
       }},
      {"box",
       "axis-aligned box",
       {{"n", count(1, 1000), 1, "quads along each edge"},
        {"size_x_m", positive("m"), 1, "size along x"},
        {"size_y_m", positive("m"), 1, "size along y"},
        {"size_z_m", positive("m"), 1, "size along z"}},
       [](const ParameterMap& p) {
         return box_mesh(integer(p, "n"),
                         Vec3d(number(p, "size_x_m"), number(p, "size_y_m"), number(p, "size_z_m")));
       }},
      {"rod",
       "straight rod of lone edges along x",
       {{"n_segments", count(1, 20000), 10, "segments"}, {"length_m", positive("m"), 1, "length"}},
       [](const ParameterMap& p) {
         const double half = 0.5 * number(p, "length_m");
         return rod_mesh(integer(p, "n_segments"), Vec3d(-half, 0, 0), Vec3d(half, 0, 0));
       }},
      {"ring",
       "closed loop of lone edges on a circle in the x-y plane",
       {{"n_segments", count(3, 20000), 24, "segments"}, {"radius_m", positive("m"), 0.5, "radius"}},
       [](const ParameterMap& p) { return ring_mesh(integer(p, "n_segments"), number(p, "radius_m")); }},
      {"helix",
       "right-handed helix of lone edges round z",
       {{"n_segments", count(1, 20000), 48, "segments"},
        {"n_turns", positive("1"), 3, "turns"},
        {"radius_m", positive("m"), 0.5, "radius"},
        {"pitch_m", positive("m"), 0.2, "rise a turn"}},
       [](const ParameterMap& p) {
         return helix_mesh(integer(p, "n_segments"), number(p, "n_turns"), number(p, "radius_m"),
                           number(p, "pitch_m"));
       }},
      {"solid_box",
       "axis-aligned box of tetrahedra, six a cell",
       {{"n_x", count(1, 1000), 4, "cells along x"},
        {"n_y", count(1, 1000), 4, "cells along y"},
        {"n_z", count(1, 1000), 4, "cells along z"},
        {"size_x_m", positive("m"), 1, "size along x"},
        {"size_y_m", positive("m"), 1, "size along y"},
        {"size_z_m", positive("m"), 1, "size along z"}},
       [](const ParameterMap& p) {
         return solid_box_mesh({integer(p, "n_x"), integer(p, "n_y"), integer(p, "n_z")},
                               Vec3d(number(p, "size_x_m"), number(p, "size_y_m"), number(p, "size_z_m")));
       }},
      {"solid_ball",
       "ball of tetrahedra, 20 n^3",
       {{"n", count(1, 200), 3, "tetrahedra from the centre to the surface"},
        {"radius_m", positive("m"), 0.5, "radius"}},
       [](const ParameterMap& p) { return solid_ball_mesh(integer(p, "n"), number(p, "radius_m")); }},
      {"solid_cylinder",
       "cylinder of tetrahedra, axis z, 18 n_radial^2 n_along",
       {{"n_radial", count(1, 1000), 2, "rings around the axis"},
        {"n_along", count(1, 1000), 4, "layers"},
        {"radius_m", positive("m"), 0.5, "radius"},
        {"length_m", positive("m"), 1, "length"}},
       [](const ParameterMap& p) {
         return solid_cylinder_mesh(integer(p, "n_radial"), integer(p, "n_along"), number(p, "radius_m"),
                                    number(p, "length_m"));
       }},
      {"solid_torus",
       "torus of tetrahedra about z, 18 n_radial^2 n_around",
       {{"n_radial", count(1, 1000), 2, "rings around the centre of the tube"},
        {"n_around", count(3, 1000), 16, "layers along the tube"},
        {"radius_m", positive("m"), 0.5, "from the axis to the centre of the tube; above thin_radius_m"},
        {"thin_radius_m", positive("m"), 0.2, "radius of the tube"}},
       [](const ParameterMap& p) {
         return solid_torus_mesh(integer(p, "n_radial"), integer(p, "n_around"), number(p, "radius_m"),
                                 number(p, "thin_radius_m"));
       }},
  });
  return list;
}

}  // namespace bb
