// A file of lines and, between them, numbers as text or as bytes: legacy VTK, Gmsh. Private to core/model/mesh.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/base/input/number_in.hpp"
#include "core/math/error.hpp"
#include "core/model/mesh/number_bytes.hpp"

namespace bb {

/// The part that is not read yet.
class MixedSource {
 public:
  MixedSource(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  void set_binary(bool big_endian) { binary_ = true, big_endian_ = big_endian; }
  bool is_binary() const { return binary_; }

  /// The words of the next line that has any. False at the end.
  bool next_line();
  void skip_line() { take_line(); }
  /// Up to an empty line.
  void skip_block();
  /// Behind a line that is this text. False where there is none.
  bool skip_past(std::string_view text);

  std::string_view line() const { return line_; }
  std::size_t words() const { return words_.size(); }
  std::string_view word(std::size_t k) const { return k < words_.size() ? words_[k] : std::string_view(); }
  std::size_t left() const { return bytes_.size() - at_; }
  /// Word k as a number of things: an integer >= 0, at most 2^40.
  long long size(std::size_t k) const;
  /// At the line that was read last.
  [[noreturn]] void fail(const std::string& found, const std::string& allowed) const;

  /// The next number, as text or of this type in bytes.
  template <class T>
  T number(const NumberType& type) {
    if (!binary_) return written<T>();
    if (left() < type.size) fail("the end of the file", "data as long as its header states");
    at_ += type.size;
    const char* at = bytes_.data() + at_ - type.size;
    if constexpr (std::is_integral_v<T>) {
      if (type.is_real) fail("numbers with fractions", "integers");
      return type.integer(at, big_endian_);
    } else {
      return type.real(at, big_endian_);
    }
  }

  /// The next n numbers. No memory is requested that the file could not fill.
  template <class T>
  std::vector<T> numbers(long long n, const NumberType& type) {
    require_left(n, type.size);
    std::vector<T> out;
    out.reserve(static_cast<std::size_t>(n));
    for (long long k = 0; k < n; ++k) out.push_back(number<T>(type));
    return out;
  }
  /// Errors: ConfigError where n things of so many bytes (in text: of one) are more than is left.
  void require_left(long long n, std::size_t bytes_each) const;

 private:
  bool take_line();
  std::string_view next_word();
  template <class T>
  T written() {
    const std::string_view text = next_word();
    const std::optional<T> value = number_in<T>(text);
    if (!value)
      fail(text.empty() ? "the end of the file" : fmt::format("\"{}\"", text.substr(0, 40)),
           "a number in range");
    return *value;
  }

  std::string_view bytes_;
  std::string name_;
  std::size_t at_ = 0;
  bool binary_ = false, big_endian_ = false;
  std::string_view line_;
  std::vector<std::string_view> words_;
};

}  // namespace bb
