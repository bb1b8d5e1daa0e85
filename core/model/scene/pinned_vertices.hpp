// The vertices that a scene prescribes.
#pragma once

#include <vector>

#include "core/model/scene/scene.hpp"

namespace bb {

/// In the order of scene.pins.
inline std::vector<int> pinned_vertices(const Scene& scene) {
  std::vector<int> out;
  out.reserve(scene.pins.size());
  for (const Pin& pin : scene.pins) out.push_back(pin.vertex);
  return out;
}

}  // namespace bb
