// Pairs that overlap in a state: what keeps it from being a start.
#pragma once

#include <optional>
#include <string>

#include "core/contact/candidates.hpp"
#include "core/contact/contact_table.hpp"

namespace bb {

/// A pair with a gap that is not positive.
struct Overlap {
  ContactKind kind;
  ContactKey key;  // all vertices of the pair
  double gap;      // m, <= 0
  std::string text;
};

/// The first of the candidates with a gap <= 0 at x, without text; then a triangle that the axis of a cylinder, or in the
/// plane the centre of a disk, passes through far from its sides. Of meshes distances only: a triangle that an edge
/// pierces without touching is the audit's to find.
std::optional<Overlap> first_overlap(const Surface& surface,
                                     const std::vector<AnalyticSurface<double>>& obstacles,
                                     const Candidates& candidates, const PositionsView& x);

}  // namespace bb
