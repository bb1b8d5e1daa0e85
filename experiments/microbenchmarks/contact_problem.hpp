// A surface in motion as a binary file, as the Python scripts beside the IPC Toolkit write it: all vertices
// free, one activation distance.
//   int32 vertices, triangles, mollify; float64 d_hat; float64 [vertices x 3] at rest, at the start, at the
//   end of the motion; int32 [triangles x 3]
#pragma once

#include <cstdint>
#include <fstream>

#include "core/contact/contact_system.hpp"

namespace bb {

struct ContactProblem {
  Scene scene;
  Positions x1;  // m, end of the motion that starts at scene.x0
  ContactOptions options;

  bool valid() const { return !scene.surface_triangles.empty(); }
};

/// Errors: not valid() when the file cannot be read or is too short.
inline ContactProblem read_contact_problem(const char* path) {
  std::ifstream in(path, std::ios::binary);
  const auto read = [&in](auto* values, std::size_t n) {
    in.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(n * sizeof(*values)));
  };
  std::int32_t n_vertices = 0, n_triangles = 0, mollify = 0;
  double d_hat = 0;
  read(&n_vertices, 1);
  read(&n_triangles, 1);
  read(&mollify, 1);
  read(&d_hat, 1);
  ContactProblem p;
  if (!in || n_vertices < 0 || n_triangles < 0) return p;
  Scene& s = p.scene;
  for (Positions* x : {&s.rest, &s.x0, &p.x1}) {
    x->resize(3, n_vertices);
    read(x->data(), static_cast<std::size_t>(x->size()));
  }
  s.surface_triangles.resize(static_cast<std::size_t>(n_triangles));
  for (auto& triangle : s.surface_triangles) read(triangle.data(), 3);
  if (!in) s.surface_triangles.clear();
  for (int v = 0; v < n_vertices; ++v) {
    s.surface_vertices.push_back(v);
    s.body.push_back(v);  // every vertex a body of its own: the rest rule does not act
    s.d_hat.push_back(d_hat);
    s.offset.push_back(0);
  }
  p.options.mollifier = mollify ? Mollifier::ipc : Mollifier::none;
  return p;
}

}  // namespace bb
