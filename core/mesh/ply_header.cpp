#include "core/mesh/ply_header.hpp"

#include "core/mesh/text_scanner.hpp"

namespace bb {
namespace {

struct TypeName {
  const char* name;
  PlyType type;
};
constexpr TypeName type_names[] = {
    {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64}};

PlyType type_of(const TextScanner& scanner, std::size_t word) {
  for (const TypeName& entry : type_names) {
    if (scanner.word(word) == entry.name) return entry.type;
  }
  scanner.fail(fmt::format("type \"{}\"", scanner.word(word)),
               "char, uchar, short, ushort, int, uint, float, double (or int8 to float64)");
}

PlyFormat format_of(const TextScanner& scanner) {
  if (scanner.word(1) == "ascii") return PlyFormat::ascii;
  if (scanner.word(1) == "binary_little_endian") return PlyFormat::little_endian;
  if (scanner.word(1) == "binary_big_endian") return PlyFormat::big_endian;
  scanner.fail(fmt::format("format \"{}\"", scanner.word(1)),
               "ascii, binary_little_endian or binary_big_endian");
}

PlyElement element_of(const TextScanner& scanner) {
  PlyElement element;
  element.name = std::string(scanner.word(1));
  element.count = scanner.integer(2);
  if (element.count < 0) scanner.fail(fmt::format("{} elements", element.count), "a count >= 0");
  return element;
}

PlyProperty property_of(const TextScanner& scanner) {
  PlyProperty property;
  property.is_list = scanner.word(1) == "list";
  if (property.is_list) {
    property.count = type_of(scanner, 2);
    if (property.count >= PlyType::float32)
      scanner.fail("a list counted in floating point", "an integer type");
  }
  const std::size_t at = property.is_list ? 3 : 1;
  property.type = type_of(scanner, at);
  property.name = std::string(scanner.word(at + 1));
  if (property.name.empty()) scanner.fail("a property without a name", "property TYPE NAME");
  return property;
}

}  // namespace

std::size_t ply_size(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

int PlyElement::find(const std::string& property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

PlyHeader parse_ply_header(const std::string& bytes, const std::string& name) {
  PlyHeader header;
  TextScanner scanner(bytes, name);
  if (!scanner.next_line() || scanner.word(0) != "ply") {
    throw ConfigError(name + ":1", "no \"ply\"", "a file that starts with the line ply");
  }
  bool has_format = false;
  while (scanner.next_line()) {
    const std::string_view key = scanner.word(0);
    if (key == "format") {
      header.format = format_of(scanner);
      has_format = true;
    } else if (key == "element") {
      header.elements.push_back(element_of(scanner));
    } else if (key == "property") {
      if (header.elements.empty()) scanner.fail("a property before any element", "element NAME COUNT first");
      header.elements.back().properties.push_back(property_of(scanner));
    } else if (key == "end_header") {
      if (!has_format) scanner.fail("no format line", "format ascii 1.0 or a binary format");
      header.body = scanner.position();
      header.body_line = scanner.line() + 1;
      return header;
    } else if (key != "comment" && key != "obj_info" && !key.empty()) {
      scanner.fail(fmt::format("\"{}\"", key), "format, element, property, comment, obj_info or end_header");
    }
  }
  throw ConfigError(name, "a header without end_header", "a whole PLY header");
}

}  // namespace bb
