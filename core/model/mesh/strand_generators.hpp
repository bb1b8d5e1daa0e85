// Procedural meshes of woven, knitted and tied bodies, and of a needle; the shapes of the scenes of Ando 2024 that are given by formulas.
// Errors of all: ConfigError for a count or size out of range, and for a mesh that does not fit into the memory of this process
// (core/base/input/memory.hpp).
#pragma once

#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// A tube with axis z woven of lone edges: n_axial >= 4 (even) straight strands of n_along vertices at the radius, and n_rings closed rings of
/// 3 n_axial vertices, in equal distances inside the length, whose radius swings by the amplitude (m), over one strand and under the next,
/// in turn from ring to ring. Ring vertices lie on the strands' angles.
struct WovenTube {
  int n_axial = 12, n_along = 24, n_rings = 8;
  double radius = 0.05, length = 0.12, amplitude = 4.8e-3;
};
TriangleMesh woven_tube_mesh(const WovenTube& tube);

/// A plain knit of lone edges about the x-y plane: n_rows strands along x of n_loops loops, n_per_loop vertices each. A loop is `loop` (m) wide and
/// reaches 0.85 of the distance `row` (m) of strands up and down, so that neighbours hook; `depth` (m) is the amplitude across the plane.
struct Knit {
  int n_rows = 4, n_loops = 4, n_per_loop = 20;
  double loop = 1.0 / 26, row = 1.0 / 52, depth = 3.9e-3;
};
TriangleMesh knit_mesh(const Knit& knit);

/// An open overhand knot in a strip of triangles: the curve (t^3 - 3 t, t^4 - 4 t^2, lift (t^5 - 10 t)), a long trefoil (Shastri 1992), of
/// |t| <= 2.2, in n_along >= 8 equal lengths, scaled to `length` (m) from end to end along x; n_across >= 2 vertices over the width (m), which lies
/// in the x-y plane. `lift`, without unit: how far crossings are apart.
struct KnottedStrip {
  int n_along = 100, n_across = 3;
  double length = 1, width = 0.05, lift = 0.1;
};
TriangleMesh knotted_strip_mesh(const KnottedStrip& strip);

/// A closed cone with its tip at the origin and its base at z = -height: n_rings rings whose distance from the tip grows with the square of
/// their number, n_base more inside the base, n_around vertices each.
TriangleMesh cone_mesh(int n_around, int n_rings, int n_base, double height, double radius);

}  // namespace bb
