// PLY bodies: one reader of values for text and one for bytes behind the same loop over
// elements and properties.
#include <algorithm>

#include "core/base/input/text_scanner.hpp"
#include "core/model/mesh/number_bytes.hpp"
#include "core/model/mesh/ply_header.hpp"
#include "core/model/mesh/raw_mesh.hpp"

namespace bb {
namespace {

/// Values of one element after another, from text: one line an element.
class AsciiValues {
 public:
  AsciiValues(const std::string& bytes, const PlyHeader& header, const std::string& name)
      : scanner_(std::string_view(bytes).substr(header.body), name, header.body_line), name_(name) {}

  void begin(const PlyElement& element, long long number) {
    do {
      if (!scanner_.next_line()) {
        throw ConfigError(fmt::format("{}: {} {}", name_, element.name, number), "the end of the file",
                          fmt::format("{} {} elements", element.count, element.name));
      }
    } while (scanner_.words().empty());
    word_ = 0;
  }
  double real(PlyType) { return scanner_.number(word_++); }
  long long integer(PlyType) { return scanner_.integer(word_++); }
  void end() const {
    if (word_ < scanner_.words().size()) {
      scanner_.fail(fmt::format("{} words", scanner_.words().size()), fmt::format("{} words", word_));
    }
  }
  long long place(long long) const { return scanner_.line(); }
  void finish() {
    while (scanner_.next_line()) {
      if (!scanner_.words().empty()) scanner_.fail("data behind the last element", "the end of the file");
    }
  }

 private:
  TextScanner scanner_;
  std::string name_;
  std::size_t word_ = 0;
};

class BinaryValues {
 public:
  BinaryValues(const std::string& bytes, const PlyHeader& header, const std::string& name)
      : bytes_(bytes), name_(name), at_(header.body), big_endian_(header.format == PlyFormat::big_endian) {}

  void begin(const PlyElement& element, long long number) {
    element_ = &element;
    number_ = number;
  }
  double real(PlyType type) {
    if (type == PlyType::float32) return static_cast<double>(take<float>());
    if (type == PlyType::float64) return take<double>();
    return static_cast<double>(integer(type));
  }
  long long integer(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>();
      case PlyType::uint8:
        return take<std::uint8_t>();
      case PlyType::int16:
        return take<std::int16_t>();
      case PlyType::uint16:
        return take<std::uint16_t>();
      case PlyType::int32:
        return take<std::int32_t>();
      case PlyType::uint32:
        return take<std::uint32_t>();
      case PlyType::float32:
      case PlyType::float64:
        break;
    }
    throw ConfigError(fmt::format("{}: {} {}", name_, element_->name, number_), "a floating-point index",
                      "an integer type");
  }
  void end() const {}
  long long place(long long number) const { return number; }
  void finish() const {
    if (at_ == bytes_.size()) return;
    throw ConfigError(name_, fmt::format("{} bytes behind the last element", bytes_.size() - at_),
                      "the end of the file");
  }

 private:
  template <class T>
  T take() {
    if (bytes_.size() - at_ < sizeof(T)) {
      throw ConfigError(fmt::format("{}: {} {}", name_, element_->name, number_),
                        fmt::format("the end of the file after {} bytes", bytes_.size()),
                        fmt::format("{} {} elements", element_->count, element_->name));
    }
    at_ += sizeof(T);
    return number_at<T>(bytes_.data() + at_ - sizeof(T), big_endian_);
  }

  const std::string& bytes_;
  std::string name_;
  std::size_t at_;
  bool big_endian_;
  const PlyElement* element_ = nullptr;
  long long number_ = 0;
};

enum class Corners { polygon, strip, tetrahedron };

/// Where the values we keep stand in an element; -1 when the element has none of them.
struct Slots {
  int x = -1, y = -1, z = -1, list = -1, edge0 = -1, edge1 = -1;
  Corners corners = Corners::polygon;  // what `list` holds
};

Slots slots_of(const PlyElement& element, const std::string& name) {
  Slots slots;
  const auto need = [&](const char* property) {
    const int at = element.find(property);
    if (at < 0 || element.properties[static_cast<std::size_t>(at)].is_list) {
      throw ConfigError(name, fmt::format("element {} without property {}", element.name, property),
                        "a number of that name");
    }
    return at;
  };
  if (element.name == "vertex") {
    slots.x = need("x"), slots.y = need("y"), slots.z = need("z");
  } else if (element.name == "face" || element.name == "tetrahedron" || element.name == "tristrips") {
    if (element.name == "tetrahedron") slots.corners = Corners::tetrahedron;
    if (element.name == "tristrips") slots.corners = Corners::strip;
    slots.list = element.find("vertex_indices");
    if (slots.list < 0 || !element.properties[static_cast<std::size_t>(slots.list)].is_list) {
      throw ConfigError(name, fmt::format("element {} without its corners", element.name),
                        "property list ... vertex_indices");
    }
  } else if (element.name == "edge") {
    slots.edge0 = need("vertex1"), slots.edge1 = need("vertex2");
  } else if (element.count > 0 && element.find("vertex_indices") >= 0) {
    throw ConfigError(name, fmt::format("element {} with vertex_indices", element.name),
                      "face, tristrips, edge and tetrahedron as elements with corners");
  }
  return slots;
}

void close_corners(Corners what, std::size_t first, long long place, RawMesh& mesh) {
  if (what == Corners::tetrahedron) return mesh.close_tetrahedron(first, place);
  if (what == Corners::polygon) return mesh.close_polygon(first, place);
  std::vector<long long> strip(mesh.corners.begin() + static_cast<std::ptrdiff_t>(first), mesh.corners.end());
  mesh.corners.resize(first);
  for (auto begin = strip.begin(); begin != strip.end();) {  // -1 stands between two strips
    const auto end = std::find(begin, strip.end(), -1);
    mesh.add_strip({begin, end}, place);
    begin = end == strip.end() ? end : end + 1;
  }
}

template <class Values>
void read_element(Values& values, const PlyElement& element, const Slots& slots, long long number,
                  RawMesh& mesh) {
  Vec3d x = Vec3d::Zero();
  std::array<long long, 2> edge{};
  const std::size_t first = mesh.corners.size();
  values.begin(element, number);
  for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
    const PlyProperty& property = element.properties[static_cast<std::size_t>(p)];
    if (property.is_list) {
      const long long count = values.integer(property.count);
      if (count < 0) {
        throw ConfigError(fmt::format("{}: {} {}", mesh.name, element.name, number),
                          fmt::format("a list of {} entries", count), "a count >= 0");
      }
      for (long long k = 0; k < count; ++k) {
        if (p == slots.list) {
          mesh.corners.push_back(values.integer(property.type));
        } else {
          values.real(property.type);
        }
      }
    } else if (p == slots.edge0 || p == slots.edge1) {
      edge[p == slots.edge0 ? 0 : 1] = values.integer(property.type);
    } else {
      const double value = values.real(property.type);
      if (p == slots.x) x[0] = value;
      if (p == slots.y) x[1] = value;
      if (p == slots.z) x[2] = value;
    }
  }
  values.end();
  const long long place = values.place(number);
  if (slots.x >= 0) mesh.add_vertex(x, place);
  if (slots.list >= 0) close_corners(slots.corners, first, place, mesh);
  if (slots.edge0 >= 0) mesh.add_segment(edge[0], edge[1], place);
}

template <class Values>
void read_body(const std::string& bytes, const PlyHeader& header, RawMesh& mesh) {
  std::vector<Slots> slots;  // of every element first: the header is judged before the body
  for (const PlyElement& element : header.elements) slots.push_back(slots_of(element, mesh.name));
  check_counts(header, bytes, mesh.name);
  Values values(bytes, header, mesh.name);
  for (std::size_t e = 0; e < slots.size(); ++e) {
    const PlyElement& element = header.elements[e];
    const bool kept = slots[e].x >= 0 || slots[e].list >= 0 || slots[e].edge0 >= 0;
    if (!kept && element.count > 0)
      mesh.left_out[fmt::format("element {}", element.name)] = {element.count, 0};
    for (long long i = 0; i < element.count; ++i) read_element(values, element, slots[e], i, mesh);
  }
  values.finish();
}

}  // namespace

RawMesh parse_ply(const std::string& bytes, const std::string& name) {
  const PlyHeader header = parse_ply_header(bytes, name);
  RawMesh mesh;
  mesh.name = name;
  mesh.places_are_lines = header.format == PlyFormat::ascii;
  if (header.format == PlyFormat::ascii) {
    read_body<AsciiValues>(bytes, header, mesh);
  } else {
    read_body<BinaryValues>(bytes, header, mesh);
  }
  return mesh;
}

}  // namespace bb
