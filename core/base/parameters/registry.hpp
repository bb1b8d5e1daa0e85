// Entries by name: the lines of a registry.inc, then what plugins added. One template for all of them, and
// one text for a name that is not there.
#pragma once

#include <deque>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// The name with the fewest edits (insert, delete, replace) from `name`; empty when none is within half of
/// its length. Cost O(total length of names x length of name).
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

/// "one of a, b, c (did you mean b?)"; the hint only where a name is near to what was found.
std::string one_of_text(std::string_view found, const std::vector<std::string>& names);

/// ConfigError text: where, the name found, "one of a, b, c (did you mean b?)".
ConfigError unknown_name(std::string_view where, std::string_view found,
                         const std::vector<std::string>& names);

/// Look-up in any list whose elements have a name.
template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  names.reserve(list.size());
  for (const auto& entry : list) names.emplace_back(entry.name);
  return names;
}
template <class List>
auto find_named(const List& list, std::string_view name) -> decltype(&*list.begin()) {
  for (const auto& entry : list) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

/// The entry of one line of a registry.inc.
template <class Entry>
Entry named(Entry entry, const char* name, const char* doc) {
  entry.name = name;
  entry.doc = doc;
  return entry;
}

/// An Entry has name and doc, and stays where it is. Not thread-safe: none is added while another thread runs.
template <class Entry>
class Registry {
 public:
  explicit Registry(std::vector<Entry> entries)
      : entries_(std::make_move_iterator(entries.begin()), std::make_move_iterator(entries.end())) {}

  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }
  std::size_t size() const { return entries_.size(); }
  const Entry& front() const { return entries_.front(); }
  std::vector<std::string> names() const { return names_of(entries_); }

  /// Null when there is none.
  const Entry* find(std::string_view name) const { return find_named(entries_, name); }
  /// Errors: unknown_name at `where`.
  const Entry& require(std::string_view name, std::string_view where) const {
    if (const Entry* entry = find(name)) return *entry;
    throw unknown_name(where, name, names());
  }
  /// Errors: ConfigError at `where` when an entry of that name is there already.
  void add(Entry entry, std::string_view where) {
    if (find(entry.name)) {
      throw ConfigError(std::string(where), '"' + std::string(entry.name) + '"',
                        "a name that is not yet taken");
    }
    entries_.push_back(std::move(entry));
  }

 private:
  std::deque<Entry> entries_;
};

}  // namespace bb
