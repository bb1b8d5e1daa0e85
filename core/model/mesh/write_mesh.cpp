#include "core/model/mesh/write_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace bb {
namespace {

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string declarations(const std::vector<PlyColumn>& columns) {
  std::string out;
  for (const PlyColumn& column : columns) {
    out += fmt::format("property {} {}\n", column.values.index() == 0 ? "int" : "double", column.name);
  }
  return out;
}

void append_row(std::string& bytes, const std::vector<PlyColumn>& columns, std::size_t row) {
  for (const PlyColumn& column : columns) {
    std::visit([&](const auto& values) { append(bytes, values[row]); }, column.values);
  }
}

}  // namespace

std::string ply_bytes(const TriangleMesh& mesh, const std::vector<PlyColumn>& of_vertices,
                      const std::vector<PlyColumn>& of_triangles) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\n{}element face {}\nproperty list uchar int vertex_indices\n{}",
      mesh.n_vertices(), declarations(of_vertices), mesh.triangles.size(), declarations(of_triangles));
  if (!mesh.segments.empty()) {
    bytes +=
        fmt::format("element edge {}\nproperty int vertex1\nproperty int vertex2\n", mesh.segments.size());
  }
  if (!mesh.tetrahedra.empty()) {
    bytes += fmt::format("element tetrahedron {}\nproperty list uchar int vertex_indices\n",
                         mesh.tetrahedra.size());
  }
  bytes += "end_header\n";
  for (int i = 0; i < mesh.n_vertices(); ++i) {
    for (int k = 0; k < 3; ++k) append(bytes, mesh.vertices(k, i));
    append_row(bytes, of_vertices, static_cast<std::size_t>(i));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    append(bytes, std::uint8_t{3});
    for (const int corner : mesh.triangles[t]) append(bytes, static_cast<std::int32_t>(corner));
    append_row(bytes, of_triangles, t);
  }
  for (const auto& s : mesh.segments) {
    for (const int end : s) append(bytes, static_cast<std::int32_t>(end));
  }
  for (const auto& t : mesh.tetrahedra) {
    append(bytes, std::uint8_t{4});
    for (const int corner : t) append(bytes, static_cast<std::int32_t>(corner));
  }
  return bytes;
}

}  // namespace bb
