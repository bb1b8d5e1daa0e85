// Mesh files: OBJ, PLY (ascii, binary of both byte orders), STL (ascii, binary). One file per format behind
// one entry point; what a mesh must satisfy is checked once, in validate.cpp.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace bb {

/// Reads a mesh; the format follows the extension (.obj, .ply, .stl, any case).
///   Convex polygons of more than three corners are split into a fan round their first corner (the corners
///   keep their order); a polygon whose corners are not in one plane is an error. OBJ lines (`l`) and PLY
///   `edge` elements become lone segments. STL corners with equal coordinates become one vertex. Normals,
///   colours, texture coordinates and groups are read past.
/// @return vertices in file units, taken as m; every index valid, no degenerate and no repeated face
/// Errors: ConfigError naming file and line (text formats) or element and number (binary formats): missing or
///   unknown file, malformed or truncated content, non-finite number, index out of range, degenerate face
///   (repeated index, zero area), repeated face or segment, no vertex at all.
/// Host only.   Cost: O(size of the file), holds the file in memory.
TriangleMesh read_mesh(const std::string& path);

/// The same from bytes; `name` stands in messages and its extension decides the format.
TriangleMesh parse_mesh(const std::string& bytes, const std::string& name);

/// Where the elements of a mesh came from, for messages.
struct MeshOrigin {
  std::string name;                // file
  std::vector<long long> vertex;   // [n_vertices] line or element number
  std::vector<long long> face;     // [n_triangles]
  std::vector<long long> segment;  // [n_segments]
  bool lines = false;              // numbers above are lines, otherwise element numbers (0-based)
};

/// Checks indices, finiteness, degenerate and repeated elements; all violations at once (at most 20).
/// Errors: ConfigError.   Cost: O(n log n).
void validate_mesh(const TriangleMesh& mesh, const MeshOrigin& origin);

}  // namespace bb
