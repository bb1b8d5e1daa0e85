// What a reader hands over: polygons as they stand in the file, with their places. Every format goes through the same
// rules from here on: of a body's mesh (assemble_mesh), or of a frame that is judged (frame_mesh.hpp). Private to core/model/mesh.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/mesh/mesh_objects.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// Numbers at the vertices of a file, as a displacement: `components` of each vertex, vertex after vertex.
struct PointField {
  std::string name;
  int components = 0;
  std::vector<double> values;  // empty when the field was not requested
};

/// What a file has and no mesh: how many, and where the first one is.
struct LeftOut {
  long long count = 0, place = 0;
};

struct RawMesh {
  std::string name;              // file, for messages
  bool places_are_lines = true;  // places below: lines of a text file, otherwise element numbers (0-based)
  const char* vertex_element = "vertex";  // what the place of a vertex counts, when not lines
  const char* cell_element =
      nullptr;                     // what the places of all cells count, when not lines; none: each its own
  long long first_number = 0;      // of a vertex, as the file counts
  std::vector<long long> numbers;  // of all vertices, where they do not follow from the first
  std::vector<Vec3d> vertices;
  std::vector<long long> vertex_place;
  std::vector<long long> corners;         // 0-based, of all polygons in a row
  std::vector<std::size_t> first_corner;  // [n_polygons]
  std::vector<long long> polygon_place;
  std::vector<std::array<long long, 2>> segments;
  std::vector<long long> segment_place;
  std::vector<std::array<long long, 4>> tetrahedra;
  std::vector<long long> tetrahedron_place;
  std::vector<std::string> object_names;  // of objects and groups, each once
  std::vector<std::vector<std::size_t>>
      object_sets;  // names that polygons and segments have together, each set once
  std::vector<std::size_t> polygon_objects,
      segment_objects;                // the set of each; empty: no names in the format
  std::vector<Vec2d> uvs;             // texture coordinates, where they were requested
  std::vector<long long> corner_uvs;  // of every corner, into uvs; -1: none, empty: not requested
  std::vector<PointField> fields;
  std::map<std::string, LeftOut>
      left_out;  // what is no surface, rod or solid: points, text, elements of other names
  std::map<std::string, LeftOut> unread;  // what no rule of the format explains

  void add_vertex(const Vec3d& x, long long place);
  /// Takes the corners appended since the last call (or since the start) as one polygon.
  void close_polygon(std::size_t first, long long place);
  /// Triangles of each three corners in a row, every second one turned over; those with a corner twice only turn.
  void add_strip(const std::vector<long long>& strip, long long place);
  void add_segment(long long a, long long b, long long place);
  /// Takes the corners from `first` on as a tetrahedron. Errors: ConfigError when they are not four.
  void close_tetrahedron(std::size_t first, long long place);
  /// Drops the polygons, or segments, for which `keep` is false.
  void keep_polygons(const std::function<bool(std::size_t)>& keep);
  void keep_segments(const std::function<bool(std::size_t)>& keep);
  std::size_t n_polygons() const { return first_corner.size(); }
  /// One past the last corner of a polygon.
  std::size_t end_corner(std::size_t polygon) const;
  /// "file:line", or "file: element number".
  std::string where(const char* element, long long place) const;
  /// A number of a vertex as the file counts them, and those that there are.
  std::string vertex_found(long long index) const;
  std::string vertices_allowed() const;
};

/// Counts one thing more of this kind.
void count_one(std::map<std::string, LeftOut>& kinds, const std::string& what, long long place);

/// A sentence for each kind of thing that was left out or not understood.
std::vector<std::string> notes_of(const RawMesh& raw);
std::string note_of(const RawMesh& raw, const std::string& what, const LeftOut& kind, const char* done);

/// Names of fields that are wanted; what else a file has at its points is listed without its values.
using FieldNames = std::set<std::string, std::less<>>;

/// Errors: ConfigError, see read_mesh.
TriangleMesh assemble_mesh(const RawMesh& raw);

/// What a file of Gmsh or VTK has and a body has not: triangles that are faces of tetrahedra (as a `skin`, those of one
/// tetrahedron stay), lines that are sides of other cells, vertices of no cell.
RawMesh without_sides(RawMesh raw, bool skin);
/// Without the vertices of no cell; a mesh with a corner that is no vertex stays as it is, and is refused later.
RawMesh without_loose_vertices(RawMesh raw);

/// Objects in the order in which the file names them first, those without faces and lines left out.
MeshObjects objects_of(const RawMesh& raw);
/// The faces and lines of those of the objects that are chosen, with their vertices; `objects` stay those of the file and learn
/// which vertices the mesh has. Errors: ConfigError for an unknown name.
RawMesh only_objects(RawMesh raw, const MeshChoice& choice, MeshObjects& objects);

/// By the extension of the name. uvs: texture coordinates too, of formats that have them. Errors: ConfigError, see read_mesh.
RawMesh parse_raw(const std::string& bytes, const std::string& name, const FieldNames& wanted = {},
                  bool uvs = false);

RawMesh parse_obj(const std::string& bytes, const std::string& name, bool uvs = false);
RawMesh parse_ply(const std::string& bytes, const std::string& name);
RawMesh parse_stl(const std::string& bytes, const std::string& name);
RawMesh parse_msh(const std::string& bytes, const std::string& name);
RawMesh parse_vtk(const std::string& bytes, const std::string& name, const FieldNames& wanted);  // legacy
RawMesh parse_vtk_xml(const std::string& bytes, const std::string& name,
                      const FieldNames& wanted);  // vtu, vtp

}  // namespace bb
