// A stack of cloth grids, near enough to touch: the scene of the contact, energy and broad-phase subjects.
#pragma once

#include "core/model/scene/scene.hpp"

namespace bb::bench {

/// `layers` sheets of n x n vertices and side 1 m, half a d_hat (5 mm) apart, each shifted a little in
/// its plane and every vertex moved at random by a tenth of d_hat: all kinds of rows occur. Start
/// positions in scene.x0.
Scene cloth_stack(int layers, int n);

/// x moved at random by up to `size` (m) in every coordinate.
Positions moved(const Positions& x, double size, unsigned seed);

}  // namespace bb::bench
