// How a quantity per area of triangles (mass, load) is split among their vertices.
#pragma once

#include "core/model/bodies/body_elements.hpp"
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

}  // namespace bb
