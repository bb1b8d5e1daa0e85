// The coefficient of a contact from those of its two sides.
#pragma once

#include <algorithm>
#include <iterator>

#include "core/contact/combine_rule.hpp"
#include "core/contact/contact_loads.hpp"
#include "core/scene/scene.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// Of contact r: its sides are the body of its first vertex, and its obstacle or the body of its last vertex.
/// @param of  of(const Body&) and of(const Obstacle&), the coefficient of a side
template <class OfSide>
double combined_of_sides(const Scene& scene, const ContactLoads& contacts, std::size_t r, CombineRule rule,
                         const OfSide& of) {
  const int* vertex = &contacts.stencil[4 * r];
  const auto of_body = [&](int v) {
    return of(scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(v)])]);
  };
  const int obstacle = contacts.obstacle[r];
  if (obstacle >= 0) {
    return combined(rule, of_body(vertex[0]), of(scene.obstacles[static_cast<std::size_t>(obstacle)]));
  }
  const auto last = std::find_if(std::reverse_iterator(vertex + 4), std::reverse_iterator(vertex),
                                 [](int id) { return id >= 0; });
  return combined(rule, of_body(vertex[0]), of_body(*last));
}

}  // namespace bb
