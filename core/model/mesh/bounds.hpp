// How far out a coordinate may be.
#pragma once

namespace bb {

/// Largest coordinate, m. Distances, areas and exact predicates multiply up to sixteen lengths, which stays
/// within double; from 1e77 on a normal is lost, from 1e154 on a squared length.
inline constexpr double max_coordinate = 1e15;

}  // namespace bb
