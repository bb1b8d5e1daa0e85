// What soft pins are in a step.
#pragma once

#include <vector>

#include "core/scene/scene.hpp"

namespace bb {

/// The elements of the term: the vertices of all pulls, pull by pull.
std::vector<int> pulled_vertices(const Scene& scene);

/// Where a vertex is pulled to, m, and how stiff, N/m.
struct PulledTo {
  Vec3d place;
  double stiffness;
};
/// Of every element in the step with that middle, as at t_end, s.
std::vector<PulledTo> pulls_of_step(const Scene& scene, double t_end, double middle);
/// Which pulls act in it, one flag a pull.
std::vector<bool> acting_pulls(const Scene& scene, double middle);

}  // namespace bb
