// Continuous collision detection of one pair over one accepted motion: certified free, proven hit, or
// unproven. Independent of the solver's ACCD: spans of time are bisected until a fixed direction
// separates the pair.
#pragma once

#include "core/audit/moving_pair.hpp"

namespace bb::audit {

enum class Verdict { certified, violation, unproven };

/// Spans of time that a verdict took.
struct Effort {
  int spans = 0;
  int exact_spans = 0;  // of them by integers
};

/// Judges x0 -> x1, linear, minimum separation 0.
///   certified: proven that the closed primitives do not meet for any t in [0, 1] (floating point with an
///   explicit
///              allowance, or integers). violation: proven by exact signs that they pass through each other.
///   unproven:  neither; a mere touch, or more spans than the cap.
/// @param tolerance m, >= 0: spans that move less are also tried by exact signs; below it spans
/// are still bisected
///                  down to rounding, so that gaps smaller than the tolerance are certified
/// @param effort    null: not requested
/// Errors: none; input must be finite. Cost: about 0.1 us where an axis separates, 1 us where the pair is
/// near, 0.1 ms where it touches all the time. Source: the inclusion idea of Snyder et al. 1993 and Wang et al.
/// 2021; here the boxes in (u, v) are replaced by a direction, which is exact in (u, v) since the polygon of
/// differences is convex.
template <class Pair>
Verdict judge(const PairMotion<Pair>& motion, double tolerance, Effort* effort = nullptr);

extern template Verdict judge<VertexTriangle>(const PairMotion<VertexTriangle>&, double, Effort*);
extern template Verdict judge<EdgeEdge>(const PairMotion<EdgeEdge>&, double, Effort*);
extern template Verdict judge<VertexEdge2d>(const PairMotion<VertexEdge2d>&, double, Effort*);

}  // namespace bb::audit
