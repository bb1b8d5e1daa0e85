// Bounds of a motion that each vertex has for itself: crossing-free for whatever parts of their motion the vertices take
// up to their bounds, each at its own pace.
#pragma once

#include <span>
#include <vector>

#include "core/contact/candidates.hpp"
#include "core/contact/step_bound.hpp"
#include "core/contact/step_bound_rule.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// planar_truncation: between the two primitives of a pair lies a plane across their closest points, which divides the gap
/// as both sides approach it; no vertex goes farther than gamma of its way to it, and one that does not approach goes all
/// of its way. Source: Divide and Truncate, arXiv 2604.15513, in the planar form that the IPC Toolkit has
/// (TrustRegion::planar_filter_step); differs by: pairs of the whole motion instead of a radius with a ball beyond it, the
/// room between the two sides taken from the vertices themselves, planes beyond balls and cylinders, which are convex.
/// planar_balanced: the same planes at another place, ours: the smallest part of a pair's vertices is the largest that any
/// place of the plane gives, where the published place leaves a vertex behind closest points that go back only what it is
/// behind.
/// per_vertex: no vertex goes farther than gamma/2 of the smallest gap of its pairs, whatever direction. Source: Chen et
/// al. 2025, Offset Geometric Contact, conservative bound of a vertex, as the IPC Toolkit has it
/// (TrustRegion::filter_step); differs by: pairs of the whole motion instead of a radius; where the other side is an
/// obstacle that stands still a vertex has gamma of the gap.
///
/// Of a pair at or below 16 ulps of its coordinates nobody goes nearer. Keeps its buffers; not thread-safe, parallel
/// inside; results do not depend on the number of threads.
class VertexBounds {
 public:
  /// gamma: in (0, 1).
  VertexBounds(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles,
               StepBoundRule rule, double gamma, Precision precision)
      : surface_(surface), obstacles_(obstacles), rule_(rule), gamma_(gamma), precision_(precision) {}

  /// candidates: of all states between x0 and x1, each vertex at its own pace (BroadPhase::update, Pace::own). alpha: the
  /// smallest part; key: its vertex. A motion that is not finite: 0 for all.
  StepBound find(const Candidates& candidates, const PositionsView& x0, const PositionsView& x1);
  /// [n_vertices] of the last find(): the part of its motion that each vertex may go, in [0, 1].
  std::span<const double> parts() const { return parts_; }

 private:
  struct Motion {
    PositionsView x0, x1;
  };
  void keep_smaller(int vertex, double part);
  double floor_of(double largest) const;
  template <PairKind K>
  void bound_pair(const ContactPair<K>& pair, const Motion& motion);
  template <int N>
  void bound_at_obstacle(const std::array<int, N>& vertex, const Side& law,
                         const AnalyticSurface<double>& given, const Motion& motion);
  /// Of a vertex across a plane, m: its height, how far it goes towards the other side, whether it carries the closest
  /// point, how far it is behind the nearest vertex of its side.
  struct SideOf {
    double height = 0, towards = 0;
    bool carries = false;
    double behind = 0;
  };
  /// Of the room between two sides, what is the first's.
  template <int N>
  static double published_share(int split, const SideOf (&of)[N]);
  template <int N>
  static double balanced_share(int split, const SideOf (&of)[N], double room);
  template <int N>
  void divide(const std::array<int, N>& vertex, int split, SideOf (&of)[N], double keep);

  const Surface& surface_;
  const std::vector<AnalyticSurface<double>>& obstacles_;
  const StepBoundRule rule_;
  const double gamma_;
  const Precision precision_;
  std::vector<double> parts_;
};

}  // namespace bb
