// XML files of VTK: the document, and its arrays of numbers (ascii, base64, appended, compressed by zlib). Private to core/model/mesh.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace bb {

class VtkXml {
 public:
  /// Errors: ConfigError for what is no XML of VTK, and for compressors that are not read.
  VtkXml(const std::string& bytes, const std::string& name);

  pugi::xml_node root() const { return root_; }
  /// Attribute `type` of <VTKFile>.
  std::string type() const { return root_.attribute("type").value(); }

  /// The n numbers of a <DataArray>. Errors: ConfigError with its name: not as many, a word that is not a number, data that
  /// ends before its length or is compressed wrongly.
  std::vector<double> reals(pugi::xml_node array, long long n) const;
  std::vector<long long> integers(pugi::xml_node array, long long n) const;

  /// A count >= 0 out of an attribute. Errors: ConfigError.
  long long count_of(pugi::xml_node node, const char* attribute, long long otherwise) const;
  [[noreturn]] void fail(pugi::xml_node node, const std::string& found, const std::string& allowed) const;

 private:
  template <class T>
  std::vector<T> numbers(pugi::xml_node array, long long n) const;
  std::string data_of(pugi::xml_node array, std::size_t most_bytes) const;
  std::string block(pugi::xml_node array, std::string_view stored, bool is_base64,
                    std::size_t most_bytes) const;
  std::string inflated(pugi::xml_node array, std::string_view stored, bool is_base64,
                       std::size_t most_bytes) const;
  std::uint64_t header_number(std::string_view bytes, std::size_t index) const;
  std::string_view appended_at(pugi::xml_node array) const;

  const std::string& bytes_;
  std::string name_;
  pugi::xml_document document_;
  pugi::xml_node root_;
  std::string_view appended_;  // behind its underscore
  bool appended_is_base64_ = false;
  bool big_endian_ = false, compressed_ = false;
  std::size_t header_size_ = 4;
};

}  // namespace bb
