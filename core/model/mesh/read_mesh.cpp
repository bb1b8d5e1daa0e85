#include "core/model/mesh/read_mesh.hpp"

#include <filesystem>

#include "core/base/input/read_file.hpp"
#include "core/math/error.hpp"
#include "core/model/mesh/raw_mesh.hpp"

namespace bb {

namespace {

std::string extension_of(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

/// Gmsh and VTK write sides of cells and points of no cell by habit; in the other formats all of it is meant.
bool has_sides(const std::string& extension) {
  return extension != ".obj" && extension != ".ply" && extension != ".stl";
}

}  // namespace

RawMesh parse_raw(const std::string& bytes, const std::string& name, const FieldNames& wanted, bool uvs) {
  const std::string extension = extension_of(name);
  if (extension == ".obj") return parse_obj(bytes, name, uvs);
  if (extension == ".ply") return parse_ply(bytes, name);
  if (extension == ".stl") return parse_stl(bytes, name);
  if (extension == ".msh") return parse_msh(bytes, name);
  if (extension == ".vtk") return parse_vtk(bytes, name, wanted);
  if (extension == ".vtu" || extension == ".vtp") return parse_vtk_xml(bytes, name, wanted);
  throw ConfigError(name, "extension \"" + extension + '"',
                    "one of .obj, .ply, .stl, .msh, .vtk, .vtu, .vtp");
}

MeshFile parse_mesh_file(const std::string& bytes, const std::string& name, const MeshChoice& choice) {
  RawMesh raw = parse_raw(bytes, name);
  if (has_sides(extension_of(name))) raw = without_sides(std::move(raw), choice.skin);
  MeshObjects objects = objects_of(raw);
  if (!choice.objects.empty()) raw = only_objects(std::move(raw), choice, objects);
  return {assemble_mesh(raw), std::move(objects), notes_of(raw)};
}

MeshObjects parse_mesh_objects(const std::string& bytes, const std::string& name) {
  return objects_of(parse_raw(bytes, name));
}

TriangleMesh parse_mesh(const std::string& bytes, const std::string& name) {
  return parse_mesh_file(bytes, name).mesh;
}

TriangleMesh read_mesh(const std::string& path) { return parse_mesh(read_input_file(path, mesh_file), path); }

}  // namespace bb
