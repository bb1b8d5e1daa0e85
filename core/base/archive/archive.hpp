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
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

/// Lists that only grow from archive to archive, apart from the archives: what is appended is written once.
struct GrownLists {
  std::map<std::string, std::uint64_t> count;  // items of each list so far
  std::string added;                           // appended since this was emptied, for add()
  std::map<std::string, std::string> bytes;    // all items of each list that was read

  /// Takes up what earlier `added` hold, one after the other. Errors: std::logic_error.
  void add(std::string text);
};

class Archive {
 public:
  /// One that is written.
  Archive() = default;
  /// One that is read.
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), reads_(true) {}
  /// The same with grown() lists in `lists`, which has to outlive it.
  explicit Archive(GrownLists& lists) : lists_(&lists) {}
  Archive(std::string bytes, GrownLists& lists) : bytes_(std::move(bytes)), reads_(true), lists_(&lists) {}

  /// Whether values are taken from the archive; else they are appended to it.
  bool reads() const { return reads_; }
  const std::string& bytes() const { return bytes_; }
  /// Everything was read.
  bool at_end() const { return at_ == bytes_.size(); }

  /// Writes or reads the values one after the other: numbers, words of an enum, strings, [3 x n] positions,
  /// standard containers of such, and objects with a member keep(Archive&) or a function keep(Archive&, T&)
  /// beside their class. Reading has to follow the order of writing. Errors: std::logic_error when it requests
  /// more than there is.
  template <class... T>
  void operator()(T&... values) {
    (item(values), ...);
  }
  /// A list of which no item changes once it was written, and none goes: with GrownLists only new items are written, and
  /// the archive itself holds their number. name: of the list, alone in its scope. Errors: std::logic_error for a list
  /// that became shorter; empty is one that is not there.
  template <class T>
  void grown(const std::string& name, std::vector<T>& list) {
    if (!lists_) return item(list);
    const std::string key = scope_ + "/" + name;
    std::uint64_t n = list.size();
    raw(&n, sizeof n);
    if (reads_) {
      Archive part(n > 0 ? lists_->bytes[key] : std::string());
      if (n > part.bytes_.size()) throw std::logic_error("archive: the list '" + key + "' is cut off");
      list.clear();
      list.resize(static_cast<std::size_t>(n));
      for (T& value : list) part.item(value);
      return;
    }
    std::uint64_t& known = lists_->count[key];
    if (n > 0 && n < known) throw std::logic_error("archive: the list '" + key + "' became shorter");
    if (n <= known) return;
    Archive part, entry;
    for (std::size_t i = static_cast<std::size_t>(known); i < list.size(); ++i) part.item(list[i]);
    known = n;
    std::string name_of = key;
    entry(name_of, n, part.bytes_);
    lists_->added += entry.bytes_;
  }
  /// Where the names of the lists that follow belong.
  void scope(std::string name) { scope_ = std::move(name); }
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
  GrownLists* lists_ = nullptr;
  std::string scope_;
};

}  // namespace bb
