#include "core/contact/pair_name.hpp"

namespace bb {

std::string pair_name(const Scene& scene, const ContactKey& key, ContactKind kind) {
  constexpr const char* names[] = {"point_point", "point_edge",    "point_triangle",   "edge_edge",
                                   "obstacle",    "obstacle_edge", "obstacle_triangle"};
  std::string out = names[static_cast<int>(kind)];
  const char* separator = ": ";
  for (int id : key) {
    if (id == -1) continue;
    out += separator;
    separator = ", ";
    if (id < -1) {
      const std::size_t o = static_cast<std::size_t>(obstacle_of(id));
      out += scene.obstacles[o].name.empty() ? "obstacle " + std::to_string(o) : scene.obstacles[o].name;
      continue;
    }
    const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(id)])];
    out += body.name + "[" + std::to_string(id - body.first_vertex) + "]";
  }
  return out;
}

}  // namespace bb
