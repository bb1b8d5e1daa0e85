// Look-up by name in a list of entries, and the error that a wrong name deserves. Shared by the registries.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// The name with the fewest edits (insert, delete, replace) from `name`; empty when none is within half of
/// its length. Cost O(total length of names x length of name).
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

/// ConfigError text: where, the name found, "one of a, b, c (did you mean b?)".
ConfigError unknown_name(std::string_view where, std::string_view found,
                         const std::vector<std::string>& names);

/// ConfigError text: where, the name found, the names that are taken.
ConfigError taken_name(std::string_view where, std::string_view name, const std::vector<std::string>& names);

template <class Entry>
std::vector<std::string> entry_names(const std::vector<Entry>& entries) {
  std::vector<std::string> names;
  names.reserve(entries.size());
  for (const Entry& entry : entries) names.push_back(entry.name);
  return names;
}

template <class Entry>
const Entry* find_entry(const std::vector<Entry>& entries, std::string_view name) {
  for (const Entry& entry : entries) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

template <class Entry>
const Entry& require_entry(const std::vector<Entry>& entries, std::string_view name, std::string_view where) {
  if (const Entry* entry = find_entry(entries, name)) return *entry;
  throw unknown_name(where, name, entry_names(entries));
}

/// Errors: ConfigError at `where` when an entry of that name is there already.
template <class Entry>
void append_entry(std::vector<Entry>& entries, Entry entry, std::string_view where) {
  if (find_entry(entries, entry.name)) throw taken_name(where, entry.name, entry_names(entries));
  entries.push_back(std::move(entry));
}

}  // namespace bb
