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
#include "core/scene/all_parts.hpp"

namespace bb {

/// Rigid motion of driven vertices: x(t) = c + R(angle(t)) (x0 - c) + velocity * s(t), s(t) = clamp(t, start,
/// end) - start, angle(t) = angular_velocity * s(t), rotation about `axis` through `center`.
struct RigidMotion {
  Vec3d velocity = Vec3d::Zero();                        // m/s
  Vec3d center = Vec3d::Zero();                          // m
  Vec3d axis = Vec3d::UnitZ();                           // unit
  double angular_velocity = 0;                           // rad/s
  double start = 0;                                      // s
  double end = std::numeric_limits<double>::infinity();  // s
  bool is_static() const { return velocity.isZero(0) && angular_velocity == 0; }
  /// R(angle(t)).
  Mat3d turn(double t) const;
};

/// A vertex whose position is prescribed exactly (static mesh, driven mesh, pin). Also the names
/// that errors use.
struct Pin {
  int vertex = 0;
  int motion = 0;  // index into Scene::motions
};

struct Body {
  std::string name;
  int first_vertex = 0, n_vertices = 0;
  std::optional<double> friction = std::nullopt;  // coefficient; absent: that of the run
};

/// Elements with a hard limit 1 + onset + width on their singular values.
struct StrainLimitPart {
  std::vector<std::array<int, 3>> triangles;
  std::vector<double> onset, width;  // [n] 1
  std::vector<double> mass;          // [n] element mass, kg
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
  std::optional<double> friction = std::nullopt;  // coefficient; absent: that of the run
  RigidMotion motion = {};                        // of its point; turns neither normal nor axis
  int vertex = -1;  // that stands for the point of an obstacle that moves, one of Scene::pins
};

enum class PlanarPairs { vertex_vertex, point_edge };

/// The elements of every part are the columns that it derives from (parts/).
struct Scene : parts::AllColumns {
  std::string name;
  bool planar = false;  // x-y plane, z locked, F is 2x2
  PlanarPairs planar_pairs = PlanarPairs::point_edge;

  std::vector<Body> bodies;
  Positions rest, x0, v0;             // [3 x n] rest, start (m), start velocity (m/s)
  std::vector<double> mass;           // [n] lumped, kg; 0 for vertices that are given
  std::vector<int> body;              // [n]
  std::vector<double> d_hat, offset;  // [n] m
  Vec3d gravity = Vec3d::Zero();      // m/s^2

  StrainLimitPart limit;

  std::vector<std::array<int, 3>> surface_triangles;  // collision surface
  std::vector<std::array<int, 2>> surface_edges;  // of triangles and rods; planar: boundary edges and rods
  std::vector<int> surface_vertices;
  std::vector<Obstacle> obstacles;

  std::vector<RigidMotion> motions;
  std::vector<Pin> pins;  // one entry a prescribed vertex, each vertex at most once

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

}  // namespace bb
