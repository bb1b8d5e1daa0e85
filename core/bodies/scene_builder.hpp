// From bodies to a Scene: appends vertices, lumps masses, collects elements, the collision surface and pins.
#pragma once

#include <string>
#include <vector>

#include "core/bodies/body_spec.hpp"
#include "core/math/error.hpp"
#include "core/scene/scene.hpp"

namespace bb {

/// Lame parameters of a shell in plane stress, times the thickness, N/m:
///   mu = E t / (2 (1 + nu)), lambda = E t nu / (1 - nu^2).
struct LameParameters {
  double mu = 0, lambda = 0;  // N/m
};
LameParameters shell_lame(double youngs_per_width, double poisson);

/// Collects bodies and obstacles, then finishes the scene. Violations are kept until finish(), so that all of
/// them are reported at once.
class SceneBuilder {
 public:
  /// `where` begins every message, e.g. the file of the configuration.
  SceneBuilder(std::string name, bool planar, const Vec3d& gravity, std::string where);

  /// Planar scenes only; before the first body.
  void set_planar_pairs(PlanarPairs pairs) { scene_.planar_pairs = pairs; }

  /// Appends a body: mass of a vertex = density x a third of its rest triangles' areas + line density x half
  /// of its segments, 0 when prescribed. Elements all of whose vertices are prescribed hold no unknown and
  /// are left out.
  void add_body(const BodySpec& spec);
  void add_obstacle(const Obstacle& obstacle);

  /// Errors: ConfigError with all violations: no free vertex, free vertex without mass, non-finite
  /// value, a name
  ///   used twice, a material or obstacle out of range, pins that select nothing, a vertex pinned to two
  ///   motions.
  Scene finish();

 private:
  void complain(const std::string& what, std::string found, std::string allowed);
  void check_name(const std::string& what, const std::string& name);
  void append_vertices(const BodySpec& spec, const Positions& start);
  void append_pins(const BodySpec& spec, const Positions& start, int first);
  void pin_vertex(const std::string& body, int vertex, int motion);
  int motion_index(const RigidMotion& motion);
  void append_masses(const BodySpec& spec, int first);
  int membrane_part(const std::string& model);
  void check_warp(const BodySpec& spec, const Vec3d& warp, int first);
  void append_membrane(const BodySpec& spec, int first);
  void append_springs(const BodySpec& spec, int first);
  void append_hinges(const BodySpec& spec, int first);
  void append_surface(const BodySpec& spec, int first);
  template <std::size_t n>
  bool all_prescribed(const std::array<int, n>& vertices) const;

  Scene scene_;
  std::string where_;
  std::vector<std::string> names_;
  std::vector<int> pin_of_;  // [n_vertices] index into scene_.pins, -1 free
  std::vector<Violation> violations_;
};

}  // namespace bb
