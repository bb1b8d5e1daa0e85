// What a reader hands over: polygons as they stand in the file, with their places. assemble_mesh checks and
// splits them, so that every format has the same rules. Private to core/mesh.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace bb {

struct RawMesh {
  std::string name;              // file, for messages
  bool places_are_lines = true;  // places below: lines of a text file, otherwise element numbers (0-based)
  const char* vertex_element = "vertex";  // what the place of a vertex counts, when not lines
  std::vector<Vec3d> vertices;
  std::vector<long long> vertex_place;
  std::vector<long long> corners;         // 0-based, of all polygons in a row
  std::vector<std::size_t> first_corner;  // [n_polygons]
  std::vector<long long> polygon_place;
  std::vector<std::array<long long, 2>> segments;
  std::vector<long long> segment_place;
  std::vector<std::array<long long, 4>> tetrahedra;
  std::vector<long long> tetrahedron_place;

  void add_vertex(const Vec3d& x, long long place);
  /// Takes the corners appended since the last call (or since the start) as one polygon.
  void close_polygon(std::size_t first, long long place);
  void add_segment(long long a, long long b, long long place);
  /// Takes the corners from `first` on as a tetrahedron. Errors: ConfigError when they are not four.
  void close_tetrahedron(std::size_t first, long long place);
  /// "file:line", or "file: element number".
  std::string where(const char* element, long long place) const;
};

/// Errors: ConfigError, see read_mesh.
TriangleMesh assemble_mesh(const RawMesh& raw);

RawMesh parse_obj(const std::string& bytes, const std::string& name);
RawMesh parse_ply(const std::string& bytes, const std::string& name);
RawMesh parse_stl(const std::string& bytes, const std::string& name);

}  // namespace bb
