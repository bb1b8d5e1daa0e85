// A word as a number.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace bb {

/// The whole word, with or without a plus before it; empty: the word is not a number, or is out of range. "nan" and "inf" are read.
template <class T>
std::optional<T> number_in(std::string_view word) {
  if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace bb
