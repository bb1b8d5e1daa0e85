#include "core/mesh/read_mesh.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

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

TriangleMesh read_mesh(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw ConfigError(path, "no such file", "a readable .obj, .ply or .stl file");
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file) throw ConfigError(path, std::string("unreadable: ") + std::strerror(errno), "a readable file");
  return parse_mesh(bytes.str(), path);
}

}  // namespace bb
