// How mass and loads of triangles are split among their vertices.
#pragma once

#include <span>
#include <vector>

#include "core/model/bodies/body_elements.hpp"
#include "core/model/bodies/body_spec.hpp"
#include "core/model/mesh/triangle_mesh.hpp"
#include "core/model/scene/parts/membrane.hpp"

namespace bb {

using parts::membrane::Lumping;

/// Adds `per_area` (kg/m^2; 1 for areas) times the area of the triangles of the mesh, split among their vertices:
///   barycentric    a third of every triangle at each corner;
///   mixed_voronoi  what of a triangle is closest to a corner; of an obtuse one half at the obtuse corner, a quarter at the
///                  others (Meyer, Desbrun, Schroder and Barr 2003, section 3.3);
///   uniform        the same at every vertex of a triangle.
/// The sum is the same for all.   Requires triangles of positive area.   Cost: O(triangles).
void lump_triangles(const TriangleMesh& mesh, Lumping lumping, double per_area, const AddMass& add);

/// What the corners of a triangle bear of a load on it, as parts of 1: as of its mass. `uniform` is a rule on all vertices of a mesh: of one
/// triangle it leaves thirds, as `barycentric` does. x: rest shape, m.   Requires a positive area.
CornerParts load_parts(const Positions& x, const std::array<int, 3>& triangle, Lumping lumping);
/// Those of the triangles of a body, behind `before` others of `all`, which stays empty while thirds are all that there is.
void append_load_parts(const BodySpec& spec, std::span<const std::array<int, 3>> triangles,
                       std::size_t before, std::vector<CornerParts>& all);

}  // namespace bb
