// Whether two meshes have the same cells.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/math/error.hpp"

namespace bb {

/// Cells of one kind of a mesh beside those of the mesh of a body, in their order. what: "triangles".
/// Errors: ConfigError at `where` for another number of them, or the first that has other vertices.
template <class Cells>
void require_same_cells(const std::string& where, const char* what, const Cells& found,
                        const Cells& allowed) {
  if (found == allowed) return;
  if (found.size() != allowed.size()) {
    throw ConfigError(where, fmt::format("{} {}", found.size(), what),
                      fmt::format("{}, as the mesh of the body has", allowed.size()));
  }
  const auto [other, own] = std::mismatch(found.begin(), found.end(), allowed.begin());
  throw ConfigError(where, fmt::format("{} {} of other vertices", what, other - found.begin()),
                    "the elements of the mesh of the body, in their order");
}

}  // namespace bb
