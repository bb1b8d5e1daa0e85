// From bodies to a Scene: appends vertices, lumps masses, collects elements, the collision surface and pins.
#pragma once

#include <string>
#include <vector>

#include "core/bodies/body_spec.hpp"
#include "core/math/error.hpp"
#include "core/scene/scene.hpp"

namespace bb {

/// Collects bodies and obstacles, then finishes the scene. Violations are kept until finish(), so that all of
/// them are reported at once.
class SceneBuilder {
 public:
  /// `where` begins every message, e.g. the file of the configuration.
  SceneBuilder(std::string name, bool planar, const Vec3d& gravity, std::string where);

  /// Planar scenes only; before the first body.
  void set_planar_pairs(PlanarPairs pairs) { scene_.planar_pairs = pairs; }
  /// Gravity as a function of time, in the place of that of the constructor; empty: that stays.
  void set_gravity(std::vector<GravityKey> keys);
  void set_air(const Air& air) { scene_.air = air; }

  /// Appends a body: what every part (part.hpp) makes of its mesh and material. The mass of a vertex is 0 when it is prescribed.
  /// Elements all of whose vertices are prescribed hold no unknown and are left out.
  void add_body(const BodySpec& spec);
  /// One with a motion gets a vertex that stands for its point, behind those of all bodies, and is a body of that vertex
  /// alone. Its `vertex` is set here.
  void add_obstacle(const Obstacle& obstacle);

  /// Errors: ConfigError with all violations: no free vertex, free vertex without mass, non-finite
  /// value, a name
  ///   used twice, a material or obstacle out of range, pins that select nothing, a vertex pinned to two
  ///   motions.
  Scene finish();

 private:
  void complain(const std::string& what, std::string found, std::string allowed);
  void check_name(const std::string& what, const std::string& name);
  void require_room(const BodySpec& spec) const;
  void append_vertices(const BodySpec& spec, const Positions& start);
  void append_pins(const BodySpec& spec, const Positions& start, int first);
  void pin_vertex(const std::string& body, int vertex, int motion);
  void check_pulls(const std::string& body);
  int motion_index(const RigidMotion& motion);
  void append_masses(const BodySpec& spec, int first);
  void append_elements(const BodySpec& spec, int first);
  void append_surface(const BodySpec& spec, int first);
  void append_obstacle_vertices();

  Scene scene_;
  std::string where_;
  std::vector<std::string> names_;
  std::vector<int> pin_of_;  // [n_vertices] index into scene_.pins, -1 free
  std::vector<Violation> violations_;
};

}  // namespace bb
