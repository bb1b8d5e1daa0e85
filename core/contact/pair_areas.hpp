// The area that a candidate pair stands for in a sum over pairs that is an integral over surfaces
// (docs/theory/contact-models.md, Weights by area).
#pragma once

#include <vector>

#include "core/contact/obstacle.hpp"
#include "core/contact/pair_id.hpp"
#include "core/contact/surface.hpp"

namespace bb {

/// Whether a pair counts as one, with its area, or with its area and corrections of pairs that share a closest feature.
enum class ContactWeighting { none, area, area_corrected };

/// Areas at rest, m^2: of a triangle, a third of it at each corner and at each side. Pairs of two surfaces have half of it,
/// since each is integrated over the other, and half of that, since points against triangles and edges against edges are
/// both sums over all of it: point and triangle A_p/4, two edges (A_a + A_b)/4. Source: Li et al. 2023, Convergent
/// Incremental Potential Contact, weights as the IPC Toolkit has them (NormalCollisions, use_area_weighting); pairs of
/// one closest feature all count, as in its collision set IPC; what its convergent set has beside is in
/// pair_corrections.hpp. Of an obstacle its point, edge or triangle has all
/// of its own; beyond a cylinder, where points and edges are both pairs, half.
class PairAreas {
 public:
  PairAreas(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles);
  /// m^2.
  double of(PairId pair) const;
  double of_point(int point) const { return points_[static_cast<std::size_t>(point)]; }
  double of_edge(int edge) const { return edges_[static_cast<std::size_t>(edge)]; }
  /// A vertex of the surface that belongs to no triangle, -1 without one: its pairs have no area.
  int without_area() const { return without_; }

 private:
  std::vector<double> points_, edges_, triangles_;  // of the primitives of the surface, m^2
  std::vector<std::uint8_t> line_;                  // of the obstacles: points and edges are both pairs
  int without_ = -1;
};

}  // namespace bb
