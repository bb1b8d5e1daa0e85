// Named parts of a mesh file: objects (o) and groups (g) of an OBJ.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace bb {

/// What the faces and lines of one name use. A name that stands in a file several times is one object.
struct MeshObject {
  std::string name;                // UTF-8
  std::vector<std::size_t> sets;   // of MeshObjects: those that the name is in, in order
  long long faces = 0, lines = 0;  // as they stand in the file, before polygons are cut
};

/// The objects of a whole file. Faces and lines that have the same names are one set, whose vertices are held once, so that what
/// is held grows with the file alone and not with names times faces.
struct MeshObjects {
  std::vector<MeshObject> list;                // in the order in which the file names them first
  std::vector<std::vector<int>> set_vertices;  // of each set, numbered as in the file from 0, sorted
  std::vector<int>
      mesh_vertex;  // of each vertex of the file, -1: the mesh leaves it out; empty: the mesh has all

  bool empty() const { return list.empty(); }
  /// The vertices of the file that an object has, sorted; one that two objects share is in both.
  std::vector<int> file_vertices(const MeshObject& object) const;
  /// Those of them that the mesh has, by their numbers there.
  std::vector<int> mesh_vertices(const MeshObject& object) const;
  /// The object of this name. Errors: ConfigError at `where` with the names that the file has.
  const MeshObject& require(const std::string& name, const std::string& file, const std::string& where) const;
};

inline constexpr std::size_t most_listed = 20;
/// The first names of a list, and how many more there are: as many as a message prints.
std::string listed(std::span<const std::string> names);

}  // namespace bb
