#include "experiments/run/body_pair.hpp"

#include <algorithm>
#include <limits>

namespace bb {

BodyPair body_pair(const Scene& scene, const ContactKey& key) {
  const auto n_bodies = static_cast<int>(scene.bodies.size());
  int low = std::numeric_limits<int>::max(), high = -1;
  for (const int id : key) {
    if (id == -1) continue;
    const int owner = id < 0 ? n_bodies + obstacle_of(id) : scene.body[static_cast<std::size_t>(id)];
    low = std::min(low, owner);
    high = std::max(high, owner);
  }
  return {low, high};
}

const std::string& owner_name(const Scene& scene, int owner) {
  const auto i = static_cast<std::size_t>(owner), n = scene.bodies.size();
  return i < n ? scene.bodies[i].name : scene.obstacles[i - n].name;
}

std::string name_of(const Scene& scene, const BodyPair& pair) {
  const auto [one, other] = std::minmax(owner_name(scene, pair.first), owner_name(scene, pair.second));
  return one + "|" + other;
}

}  // namespace bb
