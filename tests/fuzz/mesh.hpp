// The three targets of meshes differ in the name that decides the format alone.
#pragma once

#include "core/mesh/read_mesh.hpp"
#include "tests/fuzz/target.hpp"

namespace bb::fuzz {

/// A mesh that is accepted has finite vertices and only indices of these.
inline int read_mesh_bytes(const std::uint8_t* data, std::size_t size, const char* name) {
  return refused_or_read([&] {
    const TriangleMesh mesh = parse_mesh(text_of(data, size), name);
    const auto n = mesh.n_vertices();
    require(n > 0, "a mesh without vertices");
    require(mesh.vertices.allFinite(), "a vertex that is not finite");
    for (const auto& t : mesh.triangles) {
      for (const int i : t) require(i >= 0 && i < n, "a corner that is no vertex");
    }
    for (const auto& e : mesh.segments) {
      for (const int i : e) require(i >= 0 && i < n, "an end of a segment that is no vertex");
    }
  });
}

}  // namespace bb::fuzz
