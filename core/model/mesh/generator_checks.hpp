// What counts and sizes of generators must satisfy. Private to core/model/mesh.
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "core/math/error.hpp"

namespace bb {

constexpr int max_count = 20000;  // n x n triangles still count within int

inline void require_count(const char* where, int found, int low, int high) {
  if (found < low || found > high)
    throw ConfigError(where, fmt::format("{}", found), fmt::format("{} to {}", low, high));
}
inline void require_size(const char* where, double found) {
  if (!(found > 0) || !std::isfinite(found))
    throw ConfigError(where, fmt::format("{}", found), "a number > 0");
}

}  // namespace bb
