// STL, ascii and binary. It has no indices: corners with equal coordinates become one vertex,
// nothing else does.
#include <algorithm>
#include <map>

#include "core/base/input/text_scanner.hpp"
#include "core/model/mesh/number_bytes.hpp"
#include "core/model/mesh/raw_mesh.hpp"

namespace bb {
namespace {

class VertexMerger {
 public:
  explicit VertexMerger(RawMesh& mesh) : mesh_(mesh) {}
  void add_corner(Vec3d x, long long place) {
    x += Vec3d::Zero();  // -0 and 0 are one coordinate
    const auto n = static_cast<long long>(mesh_.vertices.size());
    long long index = n;
    // NaN has no place in an ordered map: such a corner stays alone until it is refused.
    if (x.allFinite()) index = index_.try_emplace({x[0], x[1], x[2]}, n).first->second;
    if (index == n) mesh_.add_vertex(x, place);
    mesh_.corners.push_back(index);
  }

 private:
  RawMesh& mesh_;
  std::map<std::array<double, 3>, long long> index_;
};

/// Some programs write the words in capitals.
std::string lower(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

void parse_ascii(const std::string& bytes, RawMesh& mesh) {
  TextScanner scanner(bytes, mesh.name);
  VertexMerger merger(mesh);
  std::size_t first = 0;
  bool in_facet = false, ended = false;
  while (scanner.next_line()) {
    const std::string key = lower(scanner.word(0));
    if (key == "solid") {
      ended = false;
    } else if (key == "facet") {
      if (ended) scanner.fail("a facet behind endsolid", "solid, or the end of the file");
      if (in_facet) scanner.fail("facet inside a facet", "endfacet first");
      in_facet = true, first = mesh.corners.size();
    } else if (key == "vertex") {
      if (!in_facet) scanner.fail("vertex outside a facet", "facet first");
      if (scanner.words().size() != 4)
        scanner.fail(fmt::format("{} words", scanner.words().size()), "vertex X Y Z");
      merger.add_corner({scanner.number(1), scanner.number(2), scanner.number(3)}, scanner.line());
    } else if (key == "endfacet") {
      if (!in_facet || mesh.corners.size() - first != 3) {
        scanner.fail(fmt::format("a facet of {} vertices", mesh.corners.size() - first), "3 vertices");
      }
      mesh.close_polygon(first, scanner.line());
      in_facet = false;
    } else if (key == "endsolid") {
      ended = true;
    } else if (key != "outer" && key != "endloop" && !key.empty()) {
      scanner.fail(fmt::format("\"{}\"", scanner.word(0)),
                   "solid, facet, outer, vertex, endloop, endfacet or endsolid");
    }
  }
  if (in_facet || !ended) scanner.fail("the end of the file", "endfacet and endsolid");
}

/// 80 bytes of comment, a 32-bit count, then 50 bytes a triangle: normal, three corners,
/// 16 bits; little-endian.
constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

void parse_binary(const std::string& bytes, RawMesh& mesh) {
  mesh.places_are_lines = false;
  mesh.vertex_element = "face";
  if (bytes.size() < header_bytes) {
    throw ConfigError(mesh.name, fmt::format("{} bytes", bytes.size()),
                      "an STL header of 84 bytes, or ascii STL");
  }
  const std::size_t n = number_at<std::uint32_t>(bytes.data() + 80, false);
  if (bytes.size() != header_bytes + n * triangle_bytes) {
    throw ConfigError(mesh.name, fmt::format("{} bytes", bytes.size()),
                      fmt::format("{} bytes for {} triangles", header_bytes + n * triangle_bytes, n));
  }
  VertexMerger merger(mesh);
  for (std::size_t t = 0; t < n; ++t) {
    const std::size_t first = mesh.corners.size();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t at = header_bytes + t * triangle_bytes + 12 * (corner + 1);
      const auto coordinate = [&](std::size_t k) {
        return static_cast<double>(number_at<float>(bytes.data() + at + 4 * k, false));
      };
      merger.add_corner({coordinate(0), coordinate(1), coordinate(2)}, static_cast<long long>(t));
    }
    mesh.close_polygon(first, static_cast<long long>(t));
  }
}

/// Binary files may start with "solid" too: the size distinguishes them.
bool is_binary(const std::string& bytes) {
  const std::size_t begin = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  if (lower(std::string_view(bytes).substr(begin, 5)) != "solid") return true;
  return bytes.size() >= header_bytes &&
         bytes.size() == header_bytes + triangle_bytes * number_at<std::uint32_t>(bytes.data() + 80, false);
}

}  // namespace

RawMesh parse_stl(const std::string& bytes, const std::string& name) {
  RawMesh mesh;
  mesh.name = name;
  if (is_binary(bytes)) {
    parse_binary(bytes, mesh);
  } else {
    parse_ascii(bytes, mesh);
  }
  return mesh;
}

}  // namespace bb
