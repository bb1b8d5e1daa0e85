// Identity of a row in KappaMemory; for its two source files.
#pragma once

#include <algorithm>
#include <tuple>
#include <type_traits>

#include "core/contact/contact_system.hpp"

namespace bb {

inline bool KappaMemory::Entry::before(const Entry& other) const {
  return std::tie(key, kind, stencil) < std::tie(other.key, other.kind, other.stencil);
}

template <class Table>
KappaMemory::Entry KappaMemory::entry(const Table& table, std::size_t row) {
  Entry e;
  e.key = table.key[row];
  e.kind = ContactKind::edge_edge;
  if constexpr (std::is_same_v<Table, ContactTable>) e.kind = table.kind[row];
  std::copy_n(table.stencil.begin() + static_cast<std::ptrdiff_t>(4 * row), 4, e.stencil.begin());
  e.kappa = table.kappa[row];
  return e;
}

}  // namespace bb
