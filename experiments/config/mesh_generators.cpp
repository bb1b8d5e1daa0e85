#include "experiments/config/mesh_generators.hpp"

#include <initializer_list>

#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "core/model/mesh/strand_generators.hpp"

namespace bb {
namespace {

using MeshGenerators = std::vector<MeshGenerator>;

/// Surfaces with a border.
MeshGenerators sheet_meshes() {
  return {{"grid",
           "rectangle in the x-y plane, every quad split along the same diagonal",
           {{"n_x", count(2, 20000), 10, "vertices along x"},
            {"n_y", count(2, 20000), 10, "vertices along y"},
            {"size_x_m", positive("m"), 1, "size along x"},
            {"size_y_m", positive("m"), 1, "size along y"}},
           [](const ParameterMap& p) {
             return grid_mesh(integer(p, "n_x"), integer(p, "n_y"), number(p, "size_x_m"),
                              number(p, "size_y_m"));
           }}};
}

/// Surfaces round a volume.
MeshGenerators closed_meshes() {
  return {
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
      {"cone",
       "closed cone, tip at the origin, base below; rings close at the tip",
       {{"n_around", count(3, 20000), 16, "vertices of a ring"},
        {"n_rings", count(1, 20000), 8, "rings between tip and base; their distance grows with the square"},
        {"n_base", count(0, 20000), 1, "rings inside the base"},
        {"height_m", positive("m"), 1, "height"},
        {"radius_m", positive("m"), 0.2, "radius of the base"}},
       [](const ParameterMap& p) {
         return cone_mesh(integer(p, "n_around"), integer(p, "n_rings"), integer(p, "n_base"),
                          number(p, "height_m"), number(p, "radius_m"));
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
       }}};
}

/// What is dressed.
MeshGenerators body_meshes() {
  return {{"torso",
           "closed trunk of a body about z, from hips to neck",
           {{"n_around", count(3, 20000), 40, "quads around"},
            {"n_along", count(1, 20000), 49, "quads along"},
            {"height_m", positive("m"), 0.9, "height; the widths follow"}},
           [](const ParameterMap& p) {
             return torso_mesh(integer(p, "n_around"), integer(p, "n_along"), number(p, "height_m"));
           }}};
}

/// Lone edges, one behind the other.
MeshGenerators strand_meshes() {
  return {{"rod",
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
           }}};
}

/// Strands and a strip that go over and under each other.
MeshGenerators entangled_meshes() {
  return {
      {"woven_tube",
       "tube about z woven of lone edges: straight strands, and rings that go over one and under the next",
       {{"n_axial", count(4, 20000), 12, "straight strands, an even number"},
        {"n_along", count(2, 20000), 24, "vertices of a strand"},
        {"n_rings", count(1, 20000), 8, "rings of 3 n_axial vertices"},
        {"radius_m", positive("m"), 0.05, "radius of the tube"},
        {"length_m", positive("m"), 0.12, "length"},
        {"amplitude_m", positive("m"), 4.8e-3, "by which the radius of a ring swings"}},
       [](const ParameterMap& p) {
         return woven_tube_mesh({integer(p, "n_axial"), integer(p, "n_along"), integer(p, "n_rings"),
                                 number(p, "radius_m"), number(p, "length_m"), number(p, "amplitude_m")});
       }},
      {"knit",
       "plain knit of lone edges in the x-y plane: strands along x whose loops hook those of their "
       "neighbours",
       {{"n_rows", count(1, 20000), 4, "strands"},
        {"n_loops", count(1, 20000), 4, "loops of a strand"},
        {"n_per_loop", count(8, 1000), 20, "vertices of a loop"},
        {"loop_m", positive("m"), 1.0 / 26, "width of a loop"},
        {"row_m", positive("m"), 1.0 / 52, "distance of strands; a loop reaches 0.85 of it up and down"},
        {"depth_m", positive("m"), 3.9e-3, "amplitude across the plane"}},
       [](const ParameterMap& p) {
         return knit_mesh({integer(p, "n_rows"), integer(p, "n_loops"), integer(p, "n_per_loop"),
                           number(p, "loop_m"), number(p, "row_m"), number(p, "depth_m")});
       }},
      {"knotted_strip",
       "strip of triangles with an open overhand knot, from end to end along x",
       {{"n_along", count(8, 20000), 100, "vertices along the strip"},
        {"n_across", count(2, 20000), 3, "vertices across"},
        {"length_m", positive("m"), 1, "from end to end"},
        {"width_m", positive("m"), 0.05, "width"},
        {"lift", positive("1"), 0.1, "how far crossings are apart"}},
       [](const ParameterMap& p) {
         return knotted_strip_mesh({integer(p, "n_along"), integer(p, "n_across"), number(p, "length_m"),
                                    number(p, "width_m"), number(p, "lift")});
       }}};
}

/// Tetrahedra.
MeshGenerators solid_meshes() {
  return {{"solid_box",
           "axis-aligned box of tetrahedra, six a cell",
           {{"n_x", count(1, 1000), 4, "cells along x"},
            {"n_y", count(1, 1000), 4, "cells along y"},
            {"n_z", count(1, 1000), 4, "cells along z"},
            {"size_x_m", positive("m"), 1, "size along x"},
            {"size_y_m", positive("m"), 1, "size along y"},
            {"size_z_m", positive("m"), 1, "size along z"}},
           [](const ParameterMap& p) {
             return solid_box_mesh(
                 {integer(p, "n_x"), integer(p, "n_y"), integer(p, "n_z")},
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
           }}};
}

MeshGenerators all_meshes(std::initializer_list<MeshGenerators> tables) {
  MeshGenerators all;
  for (const MeshGenerators& table : tables) all.insert(all.end(), table.begin(), table.end());
  return all;
}

}  // namespace

const Registry<MeshGenerator>& mesh_generators() {
  static const Registry<MeshGenerator> list(all_meshes(
      {sheet_meshes(), closed_meshes(), body_meshes(), strand_meshes(), entangled_meshes(), solid_meshes()}));
  return list;
}

}  // namespace bb
