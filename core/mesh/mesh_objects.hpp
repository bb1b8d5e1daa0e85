// Named parts of a mesh file: objects (o) and groups (g) of an OBJ.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace bb {

/// What the faces and lines of one name use. A name that stands in a file several times is one object.
struct MeshObject {
  std::string name;
  std::vector<int> vertices;       // of the mesh, sorted; a vertex that two objects share is in both
  long long faces = 0, lines = 0;  // as they stand in the file, before polygons are cut
};

/// The object of this name. Errors: ConfigError at `where` with the names that the file has.
const MeshObject& require_object(std::span<const MeshObject> objects, const std::string& name,
                                 const std::string& file, const std::string& where);

}  // namespace bb
