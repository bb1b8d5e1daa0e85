// What contact does with each pair of bodies of a scene, and why.
#pragma once

#include <string>
#include <vector>

#include "core/model/scene/scene.hpp"

namespace bb {

struct CollisionLine {
  std::string pair;  // "body|body" or "body|obstacle"
  CollisionKind kind = CollisionKind::ccd;
  std::string reason;  // one clause
};

/// Every pair of which something can move, a body and itself included; empty where the scene chooses nothing. Cost O(owners^2).
std::vector<CollisionLine> collision_lines(const Scene& scene);

}  // namespace bb
