#include "experiments/run/collision_lines.hpp"

#include <algorithm>

#include "experiments/run/body_pair.hpp"

namespace bb {
namespace {

/// [bodies] whether a vertex moves freely at some time.
std::vector<char> free_bodies(const Scene& scene) {
  std::vector<int> n_held(scene.bodies.size(), 0);
  for (const Pin& pin : scene.pins) {
    if (pin.span.always())
      ++n_held[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(pin.vertex)])];
  }
  std::vector<char> out;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) out.push_back(n_held[b] < scene.bodies[b].n_vertices);
  return out;
}

std::string reason_of(const Collisions& collisions, int a, int b) {
  if (const CollisionPair* pair = collisions.find(a, b)) return pair->reason;
  return collisions.apart_by_group(a, b) ? "of different groups" : "by default";
}

}  // namespace

std::vector<CollisionLine> collision_lines(const Scene& scene) {
  std::vector<CollisionLine> out;
  const Collisions& collisions = scene.collisions;
  if (!collisions.chosen()) return out;
  const std::vector<char> free = free_bodies(scene);
  const auto is_free = [&free](std::size_t owner) { return owner < free.size() && free[owner] != 0; };
  const std::size_t n = scene.bodies.size() + scene.obstacles.size();
  for (std::size_t a = 0; a < scene.bodies.size(); ++a) {
    for (std::size_t b = a; b < n; ++b) {
      // an obstacle that moves has a body behind those with a mesh
      const bool stands_for_one =
          b < scene.bodies.size() && scene.bodies[b].first_vertex >= scene.n_body_vertices();
      if (stands_for_one || (!is_free(a) && !is_free(b))) continue;
      const int first = static_cast<int>(a), second = static_cast<int>(b);
      out.push_back({name_of(scene, {first, second}), collisions.kind(first, second),
                     reason_of(collisions, first, second)});
    }
  }
  return out;
}

}  // namespace bb
