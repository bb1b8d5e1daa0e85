#include "core/model/mesh/ply_header.hpp"

#include "core/base/input/text_scanner.hpp"

namespace bb {
namespace {

struct TypeName {
  const char* name;
  PlyType type;
};
constexpr std::size_t max_entries = 1000;  // elements of a file, properties of an element

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

/// Refuses lines with more or fewer words: what is read past may be what the author meant.
void require_words(const TextScanner& scanner, std::size_t n, const char* allowed) {
  if (scanner.words().size() != n) scanner.fail(fmt::format("{} words", scanner.words().size()), allowed);
}

PlyFormat format_of(const TextScanner& scanner) {
  require_words(scanner, 3, "format NAME 1.0");
  if (scanner.word(2) != "1.0") scanner.fail(fmt::format("version \"{}\"", scanner.word(2)), "1.0");
  if (scanner.word(1) == "ascii") return PlyFormat::ascii;
  if (scanner.word(1) == "binary_little_endian") return PlyFormat::little_endian;
  if (scanner.word(1) == "binary_big_endian") return PlyFormat::big_endian;
  scanner.fail(fmt::format("format \"{}\"", scanner.word(1)),
               "ascii, binary_little_endian or binary_big_endian");
}

PlyElement element_of(const TextScanner& scanner, const std::vector<PlyElement>& before) {
  require_words(scanner, 3, "element NAME COUNT");
  PlyElement element;
  element.name = std::string(scanner.word(1));
  element.count = scanner.integer(2);
  if (element.count < 0) scanner.fail(fmt::format("{} elements", element.count), "a count >= 0");
  if (before.size() == max_entries) scanner.fail("one element more", fmt::format("at most {}", max_entries));
  for (const PlyElement& other : before) {
    if (other.name == element.name)
      scanner.fail(fmt::format("element {} twice", element.name), "each element once");
  }
  return element;
}

/// vertex_index and vertex_indices are two words for one property.
std::string_view one_name(std::string_view name) { return name == "vertex_index" ? "vertex_indices" : name; }

PlyProperty property_of(const TextScanner& scanner, const PlyElement& element) {
  PlyProperty property;
  property.is_list = scanner.word(1) == "list";
  if (property.is_list) {
    property.count = type_of(scanner, 2);
    if (property.count >= PlyType::float32)
      scanner.fail("a list counted in floating point", "an integer type");
  }
  const std::size_t at = property.is_list ? 3 : 1;
  property.type = type_of(scanner, at);
  require_words(scanner, at + 2, property.is_list ? "property list TYPE TYPE NAME" : "property TYPE NAME");
  property.name = std::string(one_name(scanner.word(at + 1)));
  if (element.properties.size() == max_entries) {
    scanner.fail("one property more", fmt::format("at most {}", max_entries));
  }
  if (element.find(property.name) >= 0) {
    scanner.fail(fmt::format("property {} twice", property.name), "each property of an element once");
  }
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

std::size_t PlyElement::min_bytes(PlyFormat format) const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += format == PlyFormat::ascii ? 2 : ply_size(property.is_list ? property.count : property.type);
  }
  return bytes;
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
      if (has_format) scanner.fail("format twice", "one format line");
      header.format = format_of(scanner);
      has_format = true;
    } else if (key == "element") {
      header.elements.push_back(element_of(scanner, header.elements));
    } else if (key == "property") {
      if (header.elements.empty()) scanner.fail("a property before any element", "element NAME COUNT first");
      PlyElement& element = header.elements.back();
      element.properties.push_back(property_of(scanner, element));
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

void check_counts(const PlyHeader& header, const std::string& bytes, const std::string& name) {
  // the last line of a text may end without its line feed
  auto left = static_cast<double>(bytes.size() - header.body + (header.format == PlyFormat::ascii ? 1 : 0));
  for (const PlyElement& element : header.elements) {
    if (element.count == 0) continue;
    const auto each = static_cast<double>(element.min_bytes(header.format));
    if (each == 0) {
      throw ConfigError(name, fmt::format("{} {} elements without a property", element.count, element.name),
                        "elements with properties, or a count of 0");
    }
    left -= each * static_cast<double>(element.count);
    if (left < 0) {
      throw ConfigError(
          name, fmt::format("the end of the file: {} bytes behind the header", bytes.size() - header.body),
          fmt::format("{} {} elements of at least {} bytes each, as the header states", element.count,
                      element.name, each));
    }
  }
}

}  // namespace bb
