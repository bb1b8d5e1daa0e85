// Mesh files in memory, for the tests of the readers: one tetrahedron in every format.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

namespace bb::test {

template <class T>
void append(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian == (std::endian::native == std::endian::little)) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

inline constexpr double tetrahedron_points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.25}};
inline constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

inline std::string tetrahedron_obj() {
  return "# comment\nmtllib none\nv 0 0 0\nv 1 0 0\nvn 0 0 1\nv 0 1 0\nv 0 0 1.25\n"
         "f 1 3 2\nf 1/1 2/2 4/3\nf 2//1 3//1 4//1\nf -4/1/1 -1/1/1 -2/1/1\n";
}

inline std::string ply_header(const std::string& format, const std::string& real, int n_vertices,
                              int n_faces) {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " +
         std::to_string(n_vertices) + "\nproperty " + real + " x\nproperty " + real + " y\nproperty " + real +
         " z\nproperty uchar red\n" + "element face " + std::to_string(n_faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

inline std::string tetrahedron_ply_ascii() {
  return ply_header("ascii", "float", 4, 4) +
         "0 0 0 7\n1 0 0 7\n0 1 0 7\n0 0 1.25 7\n3 0 2 1\n3 0 1 3\n\n3 1 2 3\n3 0 3 2\n";
}

template <class Real>
std::string tetrahedron_ply_binary(bool big_endian) {
  std::string bytes = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian",
                                 sizeof(Real) == 4 ? "float" : "double", 4, 4);
  for (const auto& point : tetrahedron_points) {
    for (const double x : point) append(bytes, static_cast<Real>(x), big_endian);
    append(bytes, std::uint8_t{7}, big_endian);
  }
  for (const auto& face : tetrahedron_faces) {
    append(bytes, std::uint8_t{3}, big_endian);
    for (const int v : face) append(bytes, std::int32_t{v}, big_endian);
  }
  return bytes;
}

inline std::string tetrahedron_stl_ascii() {
  std::string text = "solid tetrahedron\n";
  for (const auto& face : tetrahedron_faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int v : face) {
      text += "vertex";
      for (const double x : tetrahedron_points[v]) text += " " + std::to_string(x == 0 ? -x : x);
      text += "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

inline std::string tetrahedron_stl_binary() {
  std::string bytes = "solid by name, binary by size";
  bytes.resize(80, ' ');
  append(bytes, std::uint32_t{4}, false);
  for (const auto& face : tetrahedron_faces) {
    for (int k = 0; k < 3; ++k) append(bytes, 0.0f, false);
    for (const int v : face) {
      for (const double x : tetrahedron_points[v]) append(bytes, static_cast<float>(x), false);
    }
    append(bytes, std::uint16_t{0}, false);
  }
  return bytes;
}

}  // namespace bb::test
