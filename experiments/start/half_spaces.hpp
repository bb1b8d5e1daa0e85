// The nearest point of half-spaces, in the norm of the masses.
#pragma once

#include <array>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

/// Positions y with sum_k weight[k] normal . y[vertex[k]] >= bound, m.
struct HalfSpace {
  std::array<int, 4> vertex{-1, -1, -1, -1};  // -1 padded
  std::array<double, 4> weight{};
  Vec3d normal = Vec3d::Zero();
  double bound = 0;
};

/// The y that all half-spaces have and that is nearest to `target` [3 x n] m, by sum_v m_v |y_v - target_v|^2.
/// Vertices with inverse mass 0 stay. Where no y has all of them the last iterate is returned.
/// @param tolerance m, of the largest correction of a sweep
/// Cost: O(sweeps x half-spaces).   Source: Hildreth 1957, A quadratic programming procedure: coordinate ascent on the
/// multipliers, each of which stays >= 0.
Positions nearest_point(const Positions& target, const std::vector<HalfSpace>& sides,
                        const std::vector<double>& inverse_mass, double tolerance, int most_sweeps);

}  // namespace bb
