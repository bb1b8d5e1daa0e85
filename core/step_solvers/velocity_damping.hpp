// Damping of velocities when a step is over (Scene::damping).
#pragma once

#include "core/model/scene/scene.hpp"

namespace bb {

/// Multiplies the velocities v [3 x n] (m/s) of free vertices at the end x (m) of a step of dt (s) by the factor that acts on each, to
/// the power dt: what is left after a time does not depend on the length of its steps. A vertex is near an obstacle whose surface,
/// which stands where it is in x, is less than d_hat away, beyond the offset. Velocities stay as they are where the scene has no
/// damping. Cost: O(n) and the obstacles.
void damp_velocities(const Scene& scene, const PositionsView& x, double dt, Positions& v);

}  // namespace bb
