// How far out a coordinate may be.
#pragma once

#include <fmt/format.h>

#include <string>

#include "core/math/types.hpp"

namespace bb {

/// Largest coordinate, m. Distances, areas and exact predicates multiply up to sixteen lengths, which stays
/// within double; from 1e77 on a normal is lost, from 1e154 on a squared length.
inline constexpr double max_coordinate = 1e15;

/// Every coordinate is finite and at most max_coordinate in magnitude.
inline bool within_bounds(const Positions& x) { return (x.array().abs() <= max_coordinate).all(); }
/// In words.
inline std::string allowed_coordinates() {
  return fmt::format("finite coordinates between -{0:g} and {0:g} m", max_coordinate);
}

}  // namespace bb
