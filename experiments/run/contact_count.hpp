// How many contacts a scene has at its start, before anything of a run is made.
#pragma once

#include <cstddef>

#include "core/contact/contact_system.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

struct StartContacts {
  double total = 0;         // rows of contact between surfaces; obstacles are not among them
  double a_vertex = 0;      // of the surface
  std::size_t sampled = 0;  // vertices around which rows were counted; all of the surface where it is small
};

/// Counts the rows at x0: all of them where the surface has at most `most_counted` vertices, else those around vertices that are
/// drawn with a fixed seed, one of each of 128 equal parts of the surface, scaled to all. plan: of the scene.
/// Cost: one search of the surface where it is small, else 128 passes over its vertices, edges and triangles.
StartContacts contacts_at_start(const Scene& scene, const ContactPlan& plan, const ContactOptions& options,
                                std::size_t most_counted = 20000);

}  // namespace bb
