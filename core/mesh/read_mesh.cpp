#include "core/mesh/read_mesh.hpp"

#include <filesystem>

#include "core/input/read_file.hpp"
#include "core/math/error.hpp"
#include "core/mesh/raw_mesh.hpp"

namespace bb {

TriangleMesh parse_mesh(const std::string& bytes, const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  if (extension == ".obj") return assemble_mesh(parse_obj(bytes, name));
  if (extension == ".ply") return assemble_mesh(parse_ply(bytes, name));
  if (extension == ".stl") return assemble_mesh(parse_stl(bytes, name));
  throw ConfigError(name, "extension \"" + extension + '"', "one of .obj, .ply, .stl");
}

TriangleMesh read_mesh(const std::string& path) { return parse_mesh(read_input_file(path, mesh_file), path); }

}  // namespace bb
