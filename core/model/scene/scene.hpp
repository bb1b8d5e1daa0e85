// A scene as numbers: what every source (procedural scene, JSON bodies) is turned into before the plan is
// made. Indices are 0-based; vertex i owns column i of every [3 x n] array.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/math/types.hpp"
#include "core/model/scene/all_parts.hpp"
#include "core/model/scene/collisions.hpp"
#include "core/model/scene/motion.hpp"
#include "core/model/scene/rest_motion.hpp"
#include "core/model/scene/weight_mix.hpp"

namespace bb {

/// The time in which a pin holds or pulls, s. A step is in it when its middle is.
struct HoldSpan {
  double hold = -std::numeric_limits<double>::infinity();
  double release = std::numeric_limits<double>::infinity();

  bool always() const { return !(hold > 0) && release == std::numeric_limits<double>::infinity(); }
  bool holds(double middle) const { return middle > hold && middle < release; }
};

/// A vertex whose position is prescribed exactly (static mesh, driven mesh, pin). Also the names
/// that errors use. One that is not held for the whole run counts as free in all that belongs to a run: masses, elements,
/// contact, audit.
struct Pin {
  int vertex = 0;
  int motion = 0;  // index into Scene::motions
  HoldSpan span = {};
};

/// Stiffness of a pull at a time, as a factor >= 0.
struct PullKey {
  double time = 0;  // s
  double value = 1;
};
/// Free vertices that springs pull to where a motion takes them from their start.
struct Pull {
  std::vector<int> vertices;
  int motion = 0;                // index into Scene::motions
  double stiffness = 0;          // N/m, of each spring
  std::vector<PullKey> factors;  // empty: 1 always
  HoldSpan span = {};
  WeightMix weights = {};  // of the vertices, factors on stiffness; none: 1
};

/// Springs between single vertices.
struct Stitches {
  std::vector<std::array<int, 2>> pairs;
  std::vector<double> stiffness;    // [n] N/m
  std::vector<double> rest_length;  // [n] m
  std::vector<double> strength =
      {};  // [n] N, tension beyond which each breaks; infinite: it holds; empty: all hold

  /// The first that can break.
  std::optional<std::size_t> first_breakable() const {
    for (std::size_t i = 0; i < strength.size(); ++i) {
      if (strength[i] < std::numeric_limits<double>::infinity()) return i;
    }
    return std::nullopt;
  }
};

/// Pressure at a time.
struct PressureKey {
  double time = 0;   // s
  double value = 0;  // Pa
};
/// How the load of a triangle is split among its corners: their sum is 1.
using CornerParts = std::array<double, 3>;
/// Factors on the pressures of a body over time, of its vertices; a triangle has their mean.
struct PressureWeights {
  int first_vertex = 0, first_triangle = 0, n_triangles = 0;  // the latter two of Inflation::triangles
  WeightMix mix;
};
/// Triangles of closed surfaces that a pressure from within acts on.
struct Inflation {
  std::vector<std::array<int, 3>> triangles;
  std::vector<double> pressure;  // [n] Pa; 1 or -1 of a triangle with keys
  std::vector<int> keys;         // [n] into key_lists, -1: constant
  std::vector<std::vector<PressureKey>> key_lists;
  std::vector<CornerParts> parts;        // [n]; empty: thirds
  std::vector<PressureWeights> weights;  // of bodies that have some
};

/// Velocities are multiplied by these to the power of the step's length in s, when it is over.
struct VelocityDamping {
  double factor = 1;                                    // of free vertices, in (0, 1]
  std::optional<double> near_obstacles = std::nullopt;  // nearer to an obstacle than d_hat; absent: factor
  bool acts() const { return factor != 1 || near_obstacles.value_or(1) != 1; }
};

struct GravityKey {
  double time = 0;              // s
  Vec3d value = Vec3d::Zero();  // m/s^2
};
struct WindKey {
  double time = 0;              // s
  Vec3d value = Vec3d::Zero();  // m/s
};
/// Drag of the air on triangles, both sides together, along their normal and across it.
struct Air {
  double normal = 0, tangential = 0;  // N s/m^3, >= 0
  Vec3d wind = Vec3d::Zero();         // m/s
  std::vector<WindKey> wind_keys;     // instead of wind
};

struct Body {
  std::string name;
  int first_vertex = 0, n_vertices = 0;
  std::optional<double> friction = std::nullopt;     // coefficient; absent: that of the run
  std::optional<double> restitution = std::nullopt;  // share of the speed of meeting that is kept; absent: 1
  std::optional<double> friction_static =
      std::nullopt;  // coefficient while it sticks, >= friction; absent: as that
};

/// Elements with a hard limit 1 + onset + width on their stretches.
struct StrainBands {
  std::vector<double> onset, width;  // [n] 1
  std::vector<double> mass;          // [n] element mass, kg
};
struct StrainLimitPart : StrainBands {
  std::vector<std::array<int, 3>> triangles;
};
struct SolidLimitPart : StrainBands {
  std::vector<std::array<int, 4>> tetrahedra;
};

enum class ObstacleKind { plane, sphere, cylinder };
/// Analytic obstacle; acts on primitives with a free vertex. Signed distance positive on the allowed side.
struct Obstacle {
  std::string name;
  ObstacleKind kind = ObstacleKind::plane;
  Vec3d point = Vec3d::Zero();  // plane: a point; sphere: centre; cylinder: a point of the axis, m
  Vec3d axis = Vec3d::UnitZ();  // plane: unit normal towards the allowed side; cylinder: unit axis
  double radius = 0;            // m
  bool inside = false;          // the allowed side is the inside (sphere, cylinder)
  std::optional<double> friction = std::nullopt;         // coefficient; absent: that of the run
  std::optional<double> restitution = std::nullopt;      // as that of a body
  std::string collision_group = {};                      // of Collisions; empty: none
  PrescribedMotion motion = {};                          // of its point; turns neither normal nor axis
  std::optional<double> friction_static = std::nullopt;  // as that of a body
  int vertex = -1;  // that stands for the point of an obstacle that moves, one of Scene::pins
};

enum class PlanarPairs { vertex_vertex, point_edge };

/// The elements of every part are the columns that it derives from (parts/).
struct Scene : parts::AllColumns {
  std::string name;
  bool planar = false;  // x-y plane, z locked, F is 2x2
  PlanarPairs planar_pairs = PlanarPairs::point_edge;

  std::vector<Body> bodies;
  Positions rest, x0, v0;                // [3 x n] rest, start (m), start velocity (m/s)
  std::vector<double> mass;              // [n] lumped, kg; 0 for prescribed vertices
  std::vector<int> body;                 // [n]
  std::vector<double> d_hat, offset;     // [n] m
  Vec3d gravity = Vec3d::Zero();         // m/s^2
  std::vector<GravityKey> gravity_keys;  // gravity as a function of time; its first value is `gravity`
  Air air;
  VelocityDamping damping;
  Stitches stitches;
  Inflation inflation;

  StrainLimitPart limit;
  SolidLimitPart solid_limit;

  std::vector<std::array<int, 3>> surface_triangles;  // collision surface
  std::vector<CornerParts> corner_parts;              // [surface triangles], of drag; empty: thirds
  std::vector<std::array<int, 2>> surface_edges;  // of triangles and rods; planar: boundary edges and rods
  std::vector<int> surface_vertices;
  std::vector<Obstacle> obstacles;
  Collisions collisions;

  std::vector<RestMotion>
      rest_motions;  // of bodies whose rest shape moves: `rest` is that of the time 0 without its factor
  std::vector<PrescribedMotion> motions;
  std::vector<Pin> pins;  // one entry a prescribed vertex, each vertex at most once
  std::vector<Pull> pulls;

  int n_vertices() const { return static_cast<int>(rest.cols()); }
  /// Without those that stand for obstacles that move, which come last.
  int n_body_vertices() const {
    int n = n_vertices();
    for (const Obstacle& o : obstacles) n -= o.vertex >= 0 ? 1 : 0;
    return n;
  }
};

/// Pose of a prescribed vertex at time t (s).
Vec3d pin_pose(const Scene& scene, const Pin& pin, double t);
/// Its velocity (m/s) at the end of a step of dt (s) at t, to second order: of its poses in the last eighth of the step.
Vec3d pin_velocity(const Scene& scene, const Pin& pin, double t, double dt);
/// Which pins hold in a step whose middle is at that time (s), as indices into Scene::pins, ascending.
std::vector<int> holding_pins(const Scene& scene, double middle);
/// Degrees of freedom that no pin holds at the start of a run: three a vertex, two in the plane.
std::size_t free_dofs(const Scene& scene);
/// The scene while these pins hold and no other, as if it were so for the whole run: what is held has no mass.
Scene held_scene(const Scene& scene, const std::vector<int>& holding);
/// Gravity at time t (s), m/s^2.
Vec3d gravity_at(const Scene& scene, double t);
/// The largest |gravity| of a scene whose gravity is `constant`, or follows the keys where there are any, m/s^2.
double largest_gravity(const Vec3d& constant, const std::vector<GravityKey>& keys);

}  // namespace bb
