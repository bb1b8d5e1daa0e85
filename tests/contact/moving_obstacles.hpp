// Obstacles of a scene made by hand get the vertices that let them move.
#pragma once

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

/// Every obstacle moves with `velocity` (m/s): its vertices, behind all others, are those that SceneBuilder would make.
inline Scene with_moving_obstacles(Scene scene, const Vec3d& velocity = Vec3d::UnitX()) {
  PrescribedMotion motion;
  motion.velocity = velocity;
  scene.motions.push_back(motion);
  for (Obstacle& o : scene.obstacles) {
    const int vertex = scene.n_vertices();
    o.motion = motion;
    o.vertex = vertex;
    scene.body.push_back(static_cast<int>(scene.bodies.size()));
    scene.bodies.push_back({o.name, vertex, 1});
    for (Positions* columns : {&scene.rest, &scene.x0, &scene.v0}) {
      columns->conservativeResize(3, vertex + 1);
      columns->col(vertex) = columns == &scene.v0 ? velocity : o.point;
    }
    scene.mass.push_back(0);
    scene.d_hat.push_back(scene.d_hat.front());
    scene.offset.push_back(0);
    scene.pins.push_back({vertex, static_cast<int>(scene.motions.size()) - 1});
  }
  return scene;
}

}  // namespace bb::test
