// Mesh files: OBJ, PLY (ascii, binary of both byte orders), STL (ascii, binary). One entry point, one file a
// format; what every mesh must satisfy is checked once, in raw_mesh.cpp.
#pragma once

#include <string>

#include "core/mesh/triangle_mesh.hpp"

namespace bb {

/// Reads a mesh; the extension decides the format (.obj, .ply, .stl, any case).
///   A polygon of more than three corners is split into a fan round its first corner; a polygon of which a
///   fan triangle faces away from the whole (not convex) is an error. OBJ lines (`l`) and PLY `edge` elements
///   become lone segments, PLY `tetrahedron` elements (lists of 4 vertex_indices) tetrahedra. STL corners with equal coordinates become one vertex. Normals, colours, texture
///   coordinates, groups and unknown PLY elements are read past.
/// @return vertices in file units, taken as m
/// Errors: ConfigError naming file and line (text) or element and number (binary), at most 20 at
/// once: missing file,
///   unknown extension, malformed or truncated content, content behind the mesh, a header that announces more
///   than the file holds, non-finite number, coordinate beyond max_coordinate, index out of range, degenerate
///   face (repeated index, zero area), tetrahedron whose volume is not > 0, repeated face, segment or tetrahedron, no vertex; no regular file, or one larger
///   than mesh_file allows (core/input/read_file.hpp).
/// Host only.   Cost: O(n log n), holds the file in memory.
TriangleMesh read_mesh(const std::string& path);

/// The same from bytes; `name` is used in messages and its extension decides the format.
TriangleMesh parse_mesh(const std::string& bytes, const std::string& name);

}  // namespace bb
