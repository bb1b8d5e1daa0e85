// Mesh files: OBJ, PLY (ascii, binary of both byte orders), STL (ascii, binary), MSH of Gmsh (2.2 and 4.1, ascii and
// binary), VTK (legacy, ascii and binary) and its XML (VTU, VTP). One entry point, one file a format; what every mesh
// must satisfy is checked once, in raw_mesh.cpp. Frames that are judged have other rules: frame_mesh.hpp.
#pragma once

#include <string>
#include <vector>

#include "core/model/mesh/mesh_objects.hpp"
#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// Reads a mesh; the extension decides the format (.obj, .ply, .stl, .msh, .vtk, .vtu, .vtp, any case).
///   A polygon of more than three corners is split into a fan round its first corner, or round another one where it is not
///   convex; one that no fan covers is an error. OBJ lines (`l`), PLY `edge` elements and lines of Gmsh and VTK
///   become lone segments, PLY `tetrahedron` elements (lists of 4 vertex_indices) and tetrahedra of Gmsh and VTK tetrahedra.
///   STL corners with equal coordinates become one vertex. Of Gmsh and VTK files, triangles that are faces of tetrahedra
///   (as a `skin`, those of one tetrahedron stay), lines that are sides of other cells and points of no cell are left out.
///   Normals, colours, texture coordinates and PLY elements of other names are read past.
/// @return vertices in file units, taken as m
/// Errors: ConfigError naming file and line (text) or element and number (binary), at most 20 at
/// once: missing file,
///   unknown extension, malformed or truncated content, content behind the mesh, a header that announces more
///   than the file holds, a line of OBJ with a word that OBJ has not, a cell that is no point, line, polygon, strip or
///   tetrahedron of first order, non-finite number, coordinate beyond max_coordinate, index out of range, degenerate
///   face (repeated index, zero area), tetrahedron whose volume is not > 0, repeated face, segment or tetrahedron, no vertex; no regular file, or one larger
///   than mesh_file allows (core/base/input/read_file.hpp).
/// Host only.   Cost: O(n log n), holds the file in memory.
TriangleMesh read_mesh(const std::string& path);

/// The same from bytes; `name` is used in messages and its extension decides the format.
TriangleMesh parse_mesh(const std::string& bytes, const std::string& name);

/// What is read of a file.
struct MeshChoice {
  bool skin = false;  // triangles that are faces of one tetrahedron stay
  std::vector<std::string>
      objects;  // names of OBJ objects (o) and groups (g), with their vertices alone; none: the whole file
  std::string where;  // where the list of objects were requested, for messages; none: the file
};

struct MeshFile {
  TriangleMesh mesh;
  MeshObjects objects;             // of the whole file, also where some are chosen
  std::vector<std::string> notes;  // what was left out, a sentence a kind of thing
};

/// Errors: those of read_mesh; ConfigError for an object that the file has not.
MeshFile parse_mesh_file(const std::string& bytes, const std::string& name, const MeshChoice& choice = {});

/// The objects of a file alone; the rules of a body do not apply. Errors: those of the format.
MeshObjects parse_mesh_objects(const std::string& bytes, const std::string& name);

}  // namespace bb
