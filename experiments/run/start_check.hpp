// Whether a scene starts free of intersections: every gap positive, no edge through a triangle, no vertex on
// the wrong side of an obstacle. The last two are judged exactly, by the audit.
#pragma once

#include <optional>
#include <string>

#include "experiments/config/run_config.hpp"

namespace bb {

/// The first pair that touches or crosses at the start, in words; nothing when the start is valid.
std::optional<std::string> initial_intersection(const RunConfig& config, const Scene& scene);

}  // namespace bb
