// Which vertices a PinSpec means, and when two motions are one. Private to core/scene.
#pragma once

#include <vector>

#include "core/bodies/body_spec.hpp"

namespace bb {

/// Sorted, unique; indices are passed on unchecked. start: [3 x n] m.
std::vector<int> select_vertices(const PinSpec& spec, const Positions& start, bool planar);

/// Every number equal.
bool same_motion(const RigidMotion& a, const RigidMotion& b);

}  // namespace bb
