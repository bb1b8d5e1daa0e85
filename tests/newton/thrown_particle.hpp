// A particle that does not come to its floor at right angles: part of its motion meets the barrier, part meets nothing.
#pragma once

#include "tests/newton/small_scenes.hpp"

namespace bb::test {

/// It meets the floor z = 0 in its first step of 10 ms, where d_hat is 10 mm; nothing acts on it along x.
inline Scene thrown_particle() {
  Scene scene = particle_over_plane(0.2, 0.012, 0.01);
  scene.v0 = one_point(0.4, 0, -0.3);
  return scene;
}

}  // namespace bb::test
