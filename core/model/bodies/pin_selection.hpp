// Which vertices a PinSpec means.
#pragma once

#include <vector>

#include "core/model/bodies/body_spec.hpp"

namespace bb {

/// Sorted, unique; indices are passed on unchecked. body: that the weights are of. start: [3 x n] m.
std::vector<int> select_vertices(const PinSpec& spec, const BodySpec& body, const Positions& start,
                                 bool planar);

}  // namespace bb
