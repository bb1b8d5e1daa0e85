// CCD queries whose truth is known by construction, in small integers, so that no coordinate is rounded in double or
// float.
#pragma once

#include <cstdint>

#include "experiments/ccd/query.hpp"

namespace bb::ccd {

/// n point-triangle and n edge-edge queries, every second of which hits.
///   hits:  two points of the primitives, convex combinations in sixteenths, are the same at a time k/16; the
///          velocities are any. Families: general, on the rim, without area or length, coplanar or parallel, far from
///          the origin, at the start or the end.
///   apart: a plane keeps the primitives at least one unit of 2^-10 m apart at both ends, hence always, before a common
///          motion and an integer map of determinant 1 are applied to all.
/// Every coordinate is an integer below 2^24 times 2^-10 m. Deterministic in seed.
QuerySet random_queries(int n, std::uint64_t seed);

}  // namespace bb::ccd
