#include "core/model/mesh/vtk_xml.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "core/base/input/number_in.hpp"
#include "core/math/error.hpp"
#include "core/model/mesh/number_bytes.hpp"

namespace bb {
namespace {

constexpr std::string_view xml_blanks = " \t\r\n";
constexpr std::size_t most_deflated = 1032;  // bytes that one byte of zlib can become

/// -1: no character of base64.
int sextet(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

/// The first bytes of what base64 holds, at most n; fewer where it ends or where something else comes. Padding within it
/// is that of parts that were encoded one by one.
std::string from_base64(std::string_view text, std::size_t n) {
  std::string out;
  std::uint32_t bits = 0;
  int sextets = 0, padding = 0;
  for (const char c : text) {
    if (out.size() >= n) break;
    if (xml_blanks.find(c) != std::string_view::npos) continue;
    const int value = c == '=' ? 0 : sextet(c);
    if (value < 0) break;
    if (c == '=') ++padding;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    if (++sextets < 4) continue;
    for (int byte = 0; byte < 3 - std::min(padding, 2); ++byte) {
      out.push_back(static_cast<char>(bits >> (16 - 8 * byte) & 0xFF));
    }
    bits = 0, sextets = 0, padding = 0;
  }
  if (out.size() > n) out.resize(n);
  return out;
}

}  // namespace

VtkXml::VtkXml(const std::string& bytes, const std::string& name) : bytes_(bytes), name_(name) {
  // Raw data behind the underscore is no XML.
  const std::size_t appended = bytes.find("<AppendedData");
  std::string text = bytes.substr(0, appended);
  if (appended != std::string::npos) {
    const std::size_t tag_end = bytes.find('>', appended), mark = bytes.find('_', tag_end);
    if (tag_end == std::string::npos || mark == std::string::npos) {
      throw ConfigError(name, "appended data without its underscore", "_ before the data");
    }
    appended_is_base64_ = bytes.substr(appended, tag_end - appended).find("base64") != std::string::npos;
    appended_ = std::string_view(bytes).substr(mark + 1);
    text += "</VTKFile>";
  }
  const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size());
  root_ = document_.child("VTKFile");
  if (!parsed || !root_) {
    throw ConfigError(
        name, parsed ? "no <VTKFile>" : fmt::format("{} (byte {})", parsed.description(), parsed.offset),
        "an XML file of VTK");
  }
  big_endian_ = std::string_view(root_.attribute("byte_order").value()) == "BigEndian";
  header_size_ = std::string_view(root_.attribute("header_type").value()) == "UInt64" ? 8 : 4;
  const std::string compressor = root_.attribute("compressor").value();
  compressed_ = !compressor.empty();
  if (compressed_ && compressor != "vtkZLibDataCompressor") {
    throw ConfigError(name, "the compressor " + compressor, "vtkZLibDataCompressor, or none");
  }
}

void VtkXml::fail(pugi::xml_node node, const std::string& found, const std::string& allowed) const {
  std::string what = node.attribute("Name").value();
  if (what.empty()) what = node.parent().name();
  throw ConfigError(fmt::format("{}: <{}> \"{}\"", name_, node.name(), what), found, allowed);
}

long long VtkXml::count_of(pugi::xml_node node, const char* attribute, long long otherwise) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  const std::string_view text = found.value();
  if (!found || text.empty()) return otherwise;
  const std::optional<long long> value = number_in<long long>(text);
  if (!value || *value < 0 || *value > (1LL << 40)) {
    fail(node, fmt::format("{}=\"{}\"", attribute, text), "an integer from 0 to 2^40");
  }
  return *value;
}

std::string_view VtkXml::appended_at(pugi::xml_node array) const {
  const long long offset = count_of(array, "offset", -1);
  if (offset < 0 || static_cast<std::size_t>(offset) >= appended_.size()) {
    fail(array, fmt::format("the offset {} of {} bytes of appended data", offset, appended_.size()),
         "an offset within the appended data");
  }
  return appended_.substr(static_cast<std::size_t>(offset));
}

std::uint64_t VtkXml::header_number(std::string_view bytes, std::size_t index) const {
  const char* at = bytes.data() + index * header_size_;
  return header_size_ == 8 ? number_at<std::uint64_t>(at, big_endian_)
                           : number_at<std::uint32_t>(at, big_endian_);
}

/// The first n bytes. Errors: ConfigError where there are fewer.
std::string VtkXml::block(pugi::xml_node array, std::string_view stored, bool is_base64,
                          std::size_t n) const {
  std::string out;
  if (n <= stored.size()) out = is_base64 ? from_base64(stored, n) : std::string(stored.substr(0, n));
  if (out.size() < n) fail(array, "the end of its data", fmt::format("{} bytes", n));
  return out;
}

std::string VtkXml::inflated(pugi::xml_node array, std::string_view stored, bool is_base64,
                             std::size_t most) const {
  const std::uint64_t blocks = header_number(block(array, stored, is_base64, header_size_), 0);
  if (blocks == 0) return "";
  if (blocks > stored.size()) fail(array, fmt::format("{} blocks", blocks), "blocks within the data");
  std::size_t at = (3 + blocks) * header_size_;
  const std::string header = block(array, stored, is_base64, at);
  std::size_t end = at;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t size = header_number(header, 3 + b);
    if (size > stored.size()) fail(array, fmt::format("a block of {} bytes", size), "blocks within the data");
    end += size;
  }
  const std::string whole = block(array, stored, is_base64, end);
  std::string out;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::size_t size = header_number(header, 3 + b), last = header_number(header, 2);
    const std::uint64_t full = b + 1 == blocks && last > 0 ? last : header_number(header, 1);
    if (full > size * most_deflated || out.size() + full > most) {
      fail(array, fmt::format("a block of {} bytes that becomes {}", size, full),
           fmt::format("{} bytes in all", most));
    }
    std::string part(full, '\0');
    uLongf done = full;
    const int code = uncompress(reinterpret_cast<Bytef*>(part.data()), &done,
                                reinterpret_cast<const Bytef*>(whole.data() + at), size);
    if (code != Z_OK || done != full) fail(array, "a block that zlib cannot unpack", "whole blocks of zlib");
    out += part;
    at += size;
  }
  return out;
}

/// The bytes of an array that is not ascii.
std::string VtkXml::data_of(pugi::xml_node array, std::size_t most) const {
  const bool is_appended = std::string_view(array.attribute("format").value()) == "appended";
  const std::string_view stored = is_appended ? appended_at(array) : std::string_view(array.child_value());
  const bool is_base64 = !is_appended || appended_is_base64_;
  if (stored.find_first_not_of(xml_blanks) == std::string_view::npos) return "";
  if (compressed_) return inflated(array, stored, is_base64, most);
  const std::uint64_t n = header_number(block(array, stored, is_base64, header_size_), 0);
  if (n > most) fail(array, fmt::format("{} bytes", n), fmt::format("{} bytes", most));
  return block(array, stored, is_base64, header_size_ + n).substr(header_size_);
}

template <class T>
std::vector<T> VtkXml::numbers(pugi::xml_node array, long long n) const {
  const NumberType* type = number_type_of(array.attribute("type").value());
  if (type == nullptr || (type->is_real && std::is_integral_v<T>)) {
    fail(array, fmt::format("type \"{}\"", array.attribute("type").value()),
         std::is_integral_v<T> ? "Int8 to UInt64" : "Float32, Float64, Int8 to UInt64");
  }
  std::vector<T> out;
  const std::string_view format = array.attribute("format").value();
  if (format == "ascii" || format.empty()) {
    std::string_view text = array.child_value();
    for (std::size_t begin = text.find_first_not_of(xml_blanks); begin != std::string_view::npos;
         begin = text.find_first_not_of(xml_blanks)) {
      text.remove_prefix(begin);
      const std::string_view word = text.substr(0, text.find_first_of(xml_blanks));
      const std::optional<T> value = number_in<T>(word);
      if (!value) fail(array, fmt::format("\"{}\"", word), "a number in range");
      out.push_back(*value);
      text.remove_prefix(word.size());
    }
  } else {
    const std::string data = data_of(array, static_cast<std::size_t>(n) * type->size);
    for (std::size_t at = 0; at + type->size <= data.size(); at += type->size) {
      if constexpr (std::is_integral_v<T>) {
        out.push_back(type->integer(data.data() + at, big_endian_));
      } else {
        out.push_back(type->real(data.data() + at, big_endian_));
      }
    }
  }
  if (static_cast<long long>(out.size()) != n)
    fail(array, fmt::format("{} numbers", out.size()), fmt::format("{} numbers", n));
  return out;
}

std::vector<double> VtkXml::reals(pugi::xml_node array, long long n) const {
  return numbers<double>(array, n);
}
std::vector<long long> VtkXml::integers(pugi::xml_node array, long long n) const {
  return numbers<long long>(array, n);
}

}  // namespace bb
