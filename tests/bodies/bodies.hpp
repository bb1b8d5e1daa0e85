// Small bodies for the tests of bodies, scenes and plans.
#pragma once

#include "core/math/error.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/mesh/generators.hpp"

namespace bb::test {

inline const Vec3d down(0, 0, -9.81);

inline BodySpec cloth(const std::string& name, double height = 0) {
  BodySpec body;
  body.name = name;
  body.mesh = grid_mesh(4, 3, 1.5, 1.0);
  body.mesh.vertices.row(2).array() += height;
  body.d_hat = 0.01;
  return body;
}

inline BodySpec rigid_box(const std::string& name) {
  BodySpec body;
  body.name = name;
  body.kind = BodyKind::rigid;
  body.mesh = box_mesh(1, Vec3d(1, 1, 1));
  body.mesh.vertices.row(2).array() -= 1;
  body.d_hat = 0.01;
  return body;
}

inline Scene scene_of(const std::vector<BodySpec>& bodies, bool planar = false) {
  SceneBuilder builder("test", planar, planar ? Vec3d(0, -9.81, 0) : down, "test");
  for (const BodySpec& body : bodies) builder.add_body(body);
  return builder.finish();
}

/// All violations of a scene, as one text.
inline std::string complaint(const std::vector<BodySpec>& bodies, const std::vector<Obstacle>& obstacles = {},
                             bool planar = false) {
  try {
    SceneBuilder builder("test", planar, planar ? Vec3d(0, -9.81, 0) : down, "test");
    for (const BodySpec& body : bodies) builder.add_body(body);
    for (const Obstacle& obstacle : obstacles) builder.add_obstacle(obstacle);
    builder.finish();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

}  // namespace bb::test
