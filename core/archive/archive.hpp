// The state of objects as bytes, and back: what a step is repeated from, and what a checkpoint holds. An object
// that has state lists it once, in a function keep(Archive&), which writes and reads alike. The bytes are those of
// this machine and this program: they are no format for anybody else.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

class Archive {
 public:
  /// One that is written.
  Archive() = default;
  /// One that is read.
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), reads_(true) {}

  /// Whether values are taken from the archive; else they are appended to it.
  bool reads() const { return reads_; }
  const std::string& bytes() const { return bytes_; }
  /// Everything was read.
  bool at_end() const { return at_ == bytes_.size(); }

  /// Writes or reads the values one after the other: numbers, words of an enum, strings, [3 x n] positions,
  /// standard containers of such, and objects with a member keep(Archive&) or a function keep(Archive&, T&)
  /// beside their class. Reading has to follow the order of writing. Errors: std::logic_error when it asks for
  /// more than there is.
  template <class... T>
  void operator()(T&... values) {
    (item(values), ...);
  }
  /// A word between two parts. Errors: std::logic_error when another one is read.
  void section(std::string_view name);

 private:
  void raw(void* data, std::size_t bytes);
  /// Length of a container; what is read is at most the number of bytes left.
  std::size_t length(std::size_t n);

  template <class T>
  void item(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      raw(&value, sizeof value);
    } else if constexpr (requires { value.keep(*this); }) {
      value.keep(*this);
    } else {
      keep(*this, value);
    }
  }
  void item(std::string& text) {
    text.resize(length(text.size()));
    raw(text.data(), text.size());
  }
  void item(Positions& x) {
    const std::size_t n = length(static_cast<std::size_t>(x.cols()));
    if (reads_) x.resize(3, static_cast<Eigen::Index>(n));
    raw(x.data(), 3 * n * sizeof(double));
  }
  template <class T>
  void item(std::vector<T>& list) {
    list.resize(length(list.size()));
    if constexpr (std::is_arithmetic_v<T>) {
      raw(list.data(), list.size() * sizeof(T));
    } else {
      for (T& value : list) item(value);
    }
  }
  template <class T, std::size_t n>
  void item(std::array<T, n>& list) {
    for (T& value : list) item(value);
  }
  template <class T>
  void item(std::optional<T>& value) {
    bool there = value.has_value();
    item(there);
    if (!there) return value.reset();
    if (!value) value.emplace();
    item(*value);
  }
  template <class A, class B>
  void item(std::pair<A, B>& both) {
    item(both.first);
    item(both.second);
  }
  template <class K, class V>
  void item(std::map<K, V>& map) {
    std::vector<std::pair<K, V>> list(map.begin(), map.end());
    item(list);
    if (reads_) map = {list.begin(), list.end()};
  }
  template <class T>
  void item(std::set<T>& set) {
    std::vector<T> list(set.begin(), set.end());
    item(list);
    if (reads_) set = {list.begin(), list.end()};
  }

  std::string bytes_;
  std::size_t at_ = 0;  // of what was read
  bool reads_ = false;
};

}  // namespace bb
