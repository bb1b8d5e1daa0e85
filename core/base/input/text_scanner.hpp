// Lines and words of a text file, with line numbers and numbers that say what is wrong with them.
// Of meshes and matrices.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/base/input/number_in.hpp"
#include "core/math/error.hpp"

namespace bb {

class TextScanner {
 public:
  TextScanner(std::string_view text, std::string name, long long first_line = 1)
      : text_(text), name_(std::move(name)), next_line_(first_line) {}

  /// Splits the next line into words (blanks and tabs; a carriage return ends it). False at the end
  /// of the text.
  bool next_line() {
    if (position_ >= text_.size()) return false;
    std::size_t end = text_.find('\n', position_);
    if (end == std::string_view::npos) end = text_.size();
    split(text_.substr(position_, end - position_));
    position_ = end + 1;
    line_ = next_line_++;
    return true;
  }

  const std::vector<std::string_view>& words() const { return words_; }
  /// The line as it stands, without the blanks round it.
  std::string_view text() const {
    if (words_.empty()) return {};
    return {words_.front().data(), words_.back().data() + words_.back().size()};
  }
  std::string_view word(std::size_t i) const { return i < words_.size() ? words_[i] : std::string_view(); }
  long long line() const { return line_; }
  /// Bytes consumed, the last line's end included.
  std::size_t position() const { return std::min(position_, text_.size()); }
  std::string where() const { return fmt::format("{}:{}", name_, line_); }

  [[noreturn]] void fail(std::string found, std::string allowed) const {
    throw ConfigError(where(), std::move(found), std::move(allowed));
  }

  /// Word i as a number; "nan" and "inf" are read (they are refused later, with the other non-finite values).
  double number(std::size_t i) const { return parse<double>(i, "a number"); }
  long long integer(std::size_t i) const { return parse<long long>(i, "an integer"); }

  /// A word as a number, with or without a plus before it.
  template <class T>
  T value(std::string_view word, const std::string& allowed) const {
    const std::optional<T> value = number_in<T>(word);
    if (!value) fail(fmt::format("\"{}\"", word), allowed);
    return *value;
  }

 private:
  template <class T>
  T parse(std::size_t i, const char* allowed) const {
    if (i >= words_.size())
      fail(fmt::format("{} words", words_.size()), fmt::format("{} as word {}", allowed, i + 1));
    return value<T>(words_[i], fmt::format("{} in range", allowed));
  }

  void split(std::string_view line) {
    words_.clear();
    constexpr std::string_view blanks = " \t\r\v\f";
    std::size_t begin = line.find_first_not_of(blanks);
    while (begin != std::string_view::npos) {
      std::size_t end = line.find_first_of(blanks, begin);
      if (end == std::string_view::npos) end = line.size();
      words_.push_back(line.substr(begin, end - begin));
      begin = line.find_first_not_of(blanks, end);
    }
  }

  std::string_view text_;
  std::string name_;
  std::size_t position_ = 0;
  long long line_ = 0, next_line_;
  std::vector<std::string_view> words_;
};

}  // namespace bb
