// The header of a PLY file: format, elements and their properties. Private to core/model/mesh.
#pragma once

#include <string>
#include <vector>

namespace bb {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t ply_size(PlyType type);

struct PlyProperty {
  std::string name;  // vertex_index is kept as vertex_indices
  bool is_list = false;
  PlyType count = PlyType::uint8;  // list only
  PlyType type = PlyType::float32;
};

struct PlyElement {
  std::string name;
  long long count = 0;
  std::vector<PlyProperty> properties;
  /// Index of a property, -1 when there is none.
  int find(const std::string& property) const;
  /// Smallest size of one element: empty lists, numbers of one digit.
  std::size_t min_bytes(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;     // offset of the first byte after the header
  long long body_line = 0;  // and its line
};

/// Errors: ConfigError with file:line.
PlyHeader parse_ply_header(const std::string& bytes, const std::string& name);

/// A count is believed only as far as the file goes: every element takes its min_bytes, and some.
/// Errors: ConfigError at the file when it is too short, or for elements without a property.
void check_counts(const PlyHeader& header, const std::string& bytes, const std::string& name);

}  // namespace bb
