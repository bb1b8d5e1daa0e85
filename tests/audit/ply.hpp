// A reader for the binary PLY files of the test data, and nothing more: vertices x y z, triangles.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>

#include "core/math/types.hpp"

namespace bb::audit {

struct Ply {
  Positions x;
  Eigen::Matrix3Xi triangles;
};

/// Next value of type T, with its bytes reversed where the file is big endian.
template <class T>
T read_value(std::istream& in, bool big_endian) {
  std::array<char, sizeof(T)> bytes;
  in.read(bytes.data(), sizeof(T));
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

inline Ply read_ply(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  bool big_endian = false, wide = false;
  Eigen::Index n_vertices = 0, n_faces = 0;
  std::string line;
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    std::string first, second, third;
    words >> first >> second >> third;
    if (first == "format") big_endian = second == "binary_big_endian";
    if (first == "element") (second == "vertex" ? n_vertices : n_faces) = std::stol(third);
    if (first == "property" && third == "x") wide = second == "double";
  }
  Ply out{Positions(3, n_vertices), Eigen::Matrix3Xi(3, n_faces)};
  for (double& v : std::span(out.x.data(), static_cast<std::size_t>(out.x.size()))) {
    v = wide ? read_value<double>(in, big_endian) : static_cast<double>(read_value<float>(in, big_endian));
  }
  for (Eigen::Index f = 0; f < n_faces; ++f) {
    if (in.get() != 3) throw std::runtime_error(path.string() + ": a face that is no triangle");
    for (int k = 0; k < 3; ++k) out.triangles(k, f) = read_value<std::int32_t>(in, big_endian);
  }
  if (!in) throw std::runtime_error(path.string() + ": too short");
  return out;
}

}  // namespace bb::audit
