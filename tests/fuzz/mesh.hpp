// The targets of meshes differ in the name that decides the format alone.
#pragma once

#include <numeric>

#include "core/model/mesh/frame_mesh.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "tests/fuzz/target.hpp"

namespace bb::fuzz {

template <std::size_t N>
void require_corners(const std::vector<std::array<int, N>>& cells, int n) {
  for (const auto& cell : cells) {
    for (const int i : cell) require(i >= 0 && i < n, "a corner that is no vertex");
  }
}

/// A frame may have any positions; its corners are vertices, and each polygon has become all of its triangles. The
/// fields are read too where there are any.
inline void read_frame_bytes(const std::string& bytes, const char* name) {
  const FrameMesh listed = parse_frame(bytes, name);
  std::set<std::string, std::less<>> names;
  for (const FrameField& field : listed.fields) names.insert(field.name);
  const FrameMesh frame = parse_frame(bytes, name, names);
  const auto n = static_cast<int>(frame.vertices.cols());
  require_corners(frame.triangles, n);
  require_corners(frame.segments, n);
  require_corners(frame.tetrahedra, n);
  const long corners = std::accumulate(frame.sizes.begin(), frame.sizes.end(), 0L);
  require(corners == static_cast<long>(frame.corners.size()), "sizes that are not those of the polygons");
  require(corners - 2 * static_cast<long>(frame.sizes.size()) == static_cast<long>(frame.triangles.size()),
          "a polygon that lost a triangle");
  for (const FrameField& field : frame.fields) {
    require(field.values.size() == static_cast<std::size_t>(n) * static_cast<std::size_t>(field.components),
            "a field of other points");
  }
}

/// A mesh that is accepted has finite vertices and only indices of these.
inline int read_mesh_bytes(const std::uint8_t* data, std::size_t size, const char* name) {
  refused_or_read([&] { read_frame_bytes(text_of(data, size), name); });
  return refused_or_read([&] {
    const TriangleMesh mesh = parse_mesh(text_of(data, size), name);
    const auto n = mesh.n_vertices();
    require(n > 0, "a mesh without vertices");
    require(mesh.vertices.allFinite(), "a vertex that is not finite");
    require_corners(mesh.triangles, n);
    require_corners(mesh.segments, n);
    require_corners(mesh.tetrahedra, n);
  });
}

}  // namespace bb::fuzz
