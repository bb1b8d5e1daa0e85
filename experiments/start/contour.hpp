// The second method of repair: the curves along which surfaces cross become shorter until they are gone. It knows no
// inside and no component, so it also takes a surface apart that crosses itself.
#pragma once

#include <optional>

#include "experiments/start/tangle.hpp"

namespace bb {

/// The length of all segments in which two triangles cross, and its gradient in the positions of all vertices.
///
/// A crossing is the point p of an edge a b in a triangle with normal N. Where a vertex moves by u, the edge's point moves
/// by u_e and the triangle's by u_t, interpolated, and p by u_e + E N . (u_t - u_e) / (N . E), E = b - a: it stays on both.
/// A segment p q of two triangles has the length |p - q|, whose gradient in p is the unit vector from q to p.
/// A crossing of an edge without a triangle is part of no segment: its share is the height of the edge's nearer end over
/// the triangle's plane.
struct ContourLength {
  double length = 0;   // m
  Positions gradient;  // [3 x n]
  long crossings = 0;
};
ContourLength contour_length(const Tangle& tangle, const Positions& x);

/// The start after steps against that gradient, each vertex the faster the lighter it is, until nothing crosses; nothing
/// where the iterations end before. Positions beyond obstacles are those of separate().
/// Source of the idea to shorten the contour: Volino and Magnenat-Thalmann 2006, Resolving surface collisions through
/// intersection contour minimization.
std::optional<Positions> shorten_contours(const Tangle& tangle, int& iterations);

}  // namespace bb
