// An edge or a triangle in straight motion past a sphere or a cylinder that it has to stay outside of, and that may move
// too: certified free, proven to go in, or neither. Shares nothing with the solver's step bound.
#pragma once

#include <array>

#include "core/audit/pair_verdict.hpp"
#include "core/audit/surface.hpp"

namespace bb::audit {

/// Judges the motion x0 -> x1 (m, linear) of an edge (N = 2) or a triangle (N = 3) against an obstacle that goes straight
/// from `begin` to `end` meanwhile; only their points may differ.
///   certified: proven that no point of it is on or beyond the surface for any t in [0, 1].
///   violation: proven by exact signs that at some t one of its points is strictly beyond.
///   unproven:  neither; a mere touch, or more spans of time than the cap.
/// Errors: none; input must be finite and the obstacle one that allows no convex set. Cost: about 0.1 us where one
/// tangent plane separates, 1 us a span of time else; a motion of length l along a surface of radius r at the gap d
/// takes about l / sqrt(r d) spans.
template <std::size_t N>
Verdict judge_past_obstacle(const AuditObstacle& begin, const AuditObstacle& end,
                            const std::array<Vec3d, N>& x0, const std::array<Vec3d, N>& x1);

extern template Verdict judge_past_obstacle<2>(const AuditObstacle&, const AuditObstacle&,
                                               const std::array<Vec3d, 2>&, const std::array<Vec3d, 2>&);
extern template Verdict judge_past_obstacle<3>(const AuditObstacle&, const AuditObstacle&,
                                               const std::array<Vec3d, 3>&, const std::array<Vec3d, 3>&);

}  // namespace bb::audit
