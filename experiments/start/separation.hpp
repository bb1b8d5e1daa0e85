// The first method of repair: components that cross are shifted apart as they are, each along the direction in which
// the shortest way suffices.
#pragma once

#include <optional>
#include <vector>

#include "experiments/start/tangle.hpp"

namespace bb {

/// A way in which two components come apart.
struct Shift {
  Vec3d direction = Vec3d::UnitZ();  // unit, of the first relative to the second
  double way = 0;                    // m
};

/// The shifts by which component a leaves component b, the shortest first: along the axes, the normals of triangles that
/// cross, their edges and products of these, and the line of the middles. A way is found among eighths of that which
/// separates the projections of both on the direction, and then by bisection, with exact signs; so it is the least of a
/// direction where the two are free from some way on. Not among them: a way into a closed body of what was outside.
std::vector<Shift> shifts_apart(const Tangle& tangle, int a, int b, const Positions& x);

/// x with a shifted by that and b in the other direction, in inverse proportion to their masses, and by the gap that pairs
/// have to have.
Positions shifted(const Tangle& tangle, int a, int b, const Shift& shift, const Positions& x);

/// Pairs of components that cross at x, one after the other, each apart along its shortest shift; components beyond
/// obstacles along the obstacle's normal. Nothing where that leads to no clean state.
/// @param rank  of the shifts of the first pair the one that is taken, 0: the shortest
std::optional<Positions> separate(const Tangle& tangle, std::size_t rank);

/// All components away from the common middle, by the least factor on the distances of their middles that is clean.
std::optional<Positions> spread_out(const Tangle& tangle);

}  // namespace bb
