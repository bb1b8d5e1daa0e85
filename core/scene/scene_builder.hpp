// From bodies to a Scene: appends vertices, lumps masses, collects elements, the collision surface and pins.
#pragma once

#include <string>
#include <vector>

#include "core/scene/body_spec.hpp"
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
  /// `where` stands before every message, e.g. the file of the configuration.
  SceneBuilder(std::string name, bool planar, const Vec3d& gravity, std::string where);

  /// Appends a body: mass of a vertex = density x a third of its rest triangles' areas + line density x half
  /// of its segments. Elements all of whose vertices are prescribed are left out (they hold no unknown).
  /// Returns the index of the body.
  int add_body(const BodySpec& spec);
  void add_obstacle(const Obstacle& obstacle);
  void set_planar_pairs(PlanarPairs pairs) { scene_.planar_pairs = pairs; }

  /// Errors: ConfigError with all violations: no vertex, no free vertex, free vertex without mass, non-finite
  /// value, a name used twice, pins that select nothing, a vertex pinned twice with different motions.
  Scene finish();

 private:
  struct Range {
    int body, first, count;
  };
  void add_violation(const std::string& what, const std::string& found, const std::string& allowed);
  void check_name(const std::string& name);
  void append_vertices(const BodySpec& spec);
  void append_pins(const BodySpec& spec, int first);
  void append_elements(const BodySpec& spec, int first);
  void append_surface(const BodySpec& spec, int first);
  void pin_vertices(const BodySpec& spec, const std::vector<int>& vertices, const RigidMotion& motion);
  int motion_index(const RigidMotion& motion);
  bool all_pinned(const int* vertices, int n, int first) const;

  Scene scene_;
  std::string where_;
  std::vector<std::string> names_;
  std::vector<int> pin_of_;  // [n_vertices] index into scene_.pins, -1 free
  std::vector<Violation> violations_;
};

}  // namespace bb
