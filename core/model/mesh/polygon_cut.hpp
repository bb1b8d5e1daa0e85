// Polygons as triangles. Private to core/model/mesh.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

using Triangles = std::vector<std::array<int, 3>>;

inline constexpr std::size_t most_concave_corners =
    1000;  // of a polygon that is not convex: costs grow with the square

/// Triangles (c0 c1 c2), (c0 c2 c3), ... round one corner c0, all with an area and facing as the whole polygon does: the
/// first corner of which that holds, which is the first one of a convex polygon. None: of no corner.
std::optional<Triangles> fan_of(const Positions& x, const std::vector<int>& polygon);

/// Triangles of any polygon whose sides do not cross: that fan, otherwise ears that are cut off one after the other. None:
/// the sides cross, a coordinate is not finite, or a concave polygon has more than most_concave_corners.
std::optional<Triangles> cut_of(const Positions& x, const std::vector<int>& polygon);

/// Three corners, one after the other, lie on one line.
bool has_flat_corner(const Positions& x, const std::vector<int>& polygon);

}  // namespace bb
