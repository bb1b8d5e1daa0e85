// From bodies to a Scene: appends vertices, lumps masses, collects elements, the collision surface and pins.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/math/error.hpp"
#include "core/model/bodies/body_spec.hpp"
#include "core/model/scene/scene.hpp"

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
  void set_damping(const VelocityDamping& damping) { scene_.damping = damping; }

  /// Appends a body: what every part (part.hpp) makes of its mesh and material. The mass of a vertex is 0 when it is prescribed.
  /// Elements all of whose vertices are prescribed hold no unknown and are left out.
  void add_body(const BodySpec& spec);
  /// After the bodies that it joins. where: that of its setting, below `where` of the constructor.
  void add_stitch(const StitchSpec& stitch, const std::string& where);
  /// Of bodies and obstacles that may come later: finish() looks for them. where: as of add_stitch.
  void add_collision(const CollisionSpec& collision, const std::string& where);
  /// The step solver of that name bounds no motion: collisions cannot be `audited`, and `auto` makes none so.
  void set_unbounded_motions(const std::string& step_solver) { unbounded_by_ = step_solver; }
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
  void pin_vertex(const std::string& body, const Pin& pin);
  void check_pulls(const std::string& body);
  /// first_vertex: of the body that it moves.
  int motion_index(PrescribedMotion motion, int first_vertex);
  void append_masses(const BodySpec& spec, int first);
  void append_elements(const BodySpec& spec, int first);
  void append_surface(const BodySpec& spec, int first);
  void append_pressure(const BodySpec& spec, std::span<const std::array<int, 3>> surface, int first);
  std::vector<int> stitched(const std::string& body, const std::vector<int>& own, const std::string& where);
  std::vector<double> strengths(const StitchSpec& stitch, const std::string& where);
  void append_obstacle_vertices();
  void append_groups();
  void append_collisions();
  int owner(const std::string& name, const std::string& where);
  bool can_move(int owner) const;
  bool has_triangles(int owner) const;
  std::string owner_name(int owner) const;
  CollisionPair decide(const CollisionSpec& spec, int a, int b) const;
  CollisionPair decide_open(int first, int second, const std::string& why) const;
  bool allows(const CollisionPair& pair, const std::string& where);

  Scene scene_;
  std::string where_;
  std::vector<std::string> names_;
  std::vector<int> pin_of_;                        // [n_vertices] index into scene_.pins, -1 free
  std::vector<int> held_;                          // the same of pins that hold for the whole run
  std::vector<char> closed_;                       // [bodies] whether the surface closes
  std::vector<std::string> groups_;                // [bodies]
  std::vector<std::vector<WeightGroup>> weights_;  // [bodies]
  std::vector<CollisionSpec> collisions_;
  std::vector<std::string> collisions_at_;  // where each is
  std::string unbounded_by_;  // the step solver that bounds no motion; empty: motions are bounded
  std::vector<Violation> violations_;
};

}  // namespace bb
