// Exact signs of determinants of doubles. Shares nothing with the solver's geometry, which it judges.
// Needs -ffp-contract=off: a fused multiply-add would break the proofs of the floating filters.
#pragma once

#include "core/math/types.hpp"

namespace bb::audit {

/// Sign of det[b - a, c - a]: +1 if a, b, c turn left, -1 if right, 0 if they are exactly collinear.
/// Total for finite input. Filter: |det| > 8 eps * permanent; below it exact integers (GMP).
int orient2d(const Vec2d& a, const Vec2d& b, const Vec2d& c);

/// Sign of det[b - a, c - a, d - a] = (b-a)x(c-a).(d-a): +1 if d lies on the side of the normal of a, b, c,
/// 0 if the four are exactly coplanar. Total for finite input. (Shewchuk 1997 uses the opposite sign.)
int orient3d(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// The same signs by integers alone, without the filter: what the self-test and the tests compare with.
int orient2d_exact(const Vec2d& a, const Vec2d& b, const Vec2d& c);
int orient3d_exact(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// False if this build or machine breaks the predicates: contracted products, extended precision, or a filter
/// that disagrees with the integers on near-degenerate input. Cost: about a millisecond.
bool predicates_self_test();

}  // namespace bb::audit
