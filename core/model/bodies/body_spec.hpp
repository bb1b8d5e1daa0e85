// What a body is before it becomes columns of a Scene: mesh, material, motion, pins.
// Turned into a Scene by scene_builder.hpp.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/mesh/triangle_mesh.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// Hard limit 1 + onset + width on the stretches of triangles, and of tetrahedra where `solids` is set (docs/theory/strain-limit.md).
struct StrainLimitSpec {
  double onset = 0.01, width = 0.01;  // 1
  bool solids = false;
};

/// What a body states of all parts that it can be made of (core/model/scene/parts). Stiffness 0 switches elements off.
struct Material : parts::AllKeys {
  std::optional<StrainLimitSpec> limit;  // absent: no limit

  /// Rate (1/s) at which a rest shape follows that has `own` of its own: that, or plasticity as a rate, with which the part
  /// 1 - plasticity is left after plasticity_step.
  double creep_rate(double own) const;
};

/// A number in [0, 1] for every vertex of a body.
struct WeightGroup {
  std::string name;
  std::vector<double> weight;  // [n vertices]
};
/// A group of the body in a mix (core/model/scene/weight_mix.hpp).
struct WeightShare {
  std::string group;
  double influence = 1;            // in [-1, 1]
  std::vector<InfluenceKey> keys;  // of the influence, instead; empty: constant
};

enum class StiffnessKind { membrane, hinges, springs };  // springs: of edges and of cloth
/// A factor on stiffnesses of elements: low + (high - low) times the mean of the mixed weights of their vertices.
struct StiffnessWeights {
  StiffnessKind of = StiffnessKind::membrane;
  std::vector<WeightShare> mix;  // constant
  double low = 0, high = 1;      // >= 0
};

/// Which vertices of a body are prescribed, or pulled; a vertex is selected when any of the given ways selects it.
struct PinSpec {
  std::vector<int> indices;                 // of the body's own vertices
  std::vector<std::string> objects;         // of the mesh file; build_scene adds their vertices to indices
  std::optional<std::array<Vec3d, 2>> box;  // closed box (min, max) in start positions, m
  bool top_row = false;                     // vertices with the largest start y (planar) or z, exactly
  bool all = false;
  std::vector<WeightShare>
      mix;  // of a pull: factors on the stiffness of each vertex, which select those that have any
  std::optional<double>
      threshold;  // selects vertices whose mixed weight is at least this, in (0, 1]; constant influences
  PrescribedMotion motion;            // static by default
  std::optional<double> pull;         // N/m, of springs from free vertices to there; absent: they are there
  std::vector<PullKey> pull_factors;  // of it; empty: 1
  HoldSpan span;                      // in which it holds or pulls
};

/// Springs between vertices of two bodies, or of one: each of a_vertices to that of b_vertices in its place.
struct StitchSpec {
  std::string a, b;                         // names of the bodies
  std::vector<int> a_vertices, b_vertices;  // of their own meshes
  double stiffness = 0;                     // N/m, of each spring, > 0
  double rest_length = 0;                   // m, >= 0
  std::optional<double> strength = {};  // N, > 0: the tension beyond which a spring breaks; absent: none does
  std::string weights = {};             // a group of a, factors on strength by a_vertices; empty: 1
};

/// What is required of a pair: a CollisionKind, or the one that follows from whether the two surfaces close.
enum class CollisionChoice { automatic, ccd, audited, static_test, proximity, off };

/// What contact does with two bodies, a body and an obstacle, or a body with itself.
struct CollisionSpec {
  std::string a, b;  // names
  CollisionChoice choice = CollisionChoice::automatic;
};

enum class BodyKind { deformable, rigid };  // rigid: every vertex prescribed, no mass, no elements

struct BodySpec {
  std::string name;
  BodyKind kind = BodyKind::deformable;
  TriangleMesh mesh;               // rest shape, m
  std::optional<Positions> start;  // start positions where they differ from the rest shape, m
  std::shared_ptr<const Film>
      rest_film;      // deformable only; of the rest shape over time: mesh is its place at the time 0
  Material material;  // deformable only
  Vec3d velocity = Vec3d::Zero();          // m/s, free vertices
  PrescribedMotion motion;                 // rigid only
  std::vector<PinSpec> pins;               // deformable only
  double d_hat = 0;                        // m, > 0
  double offset = 0;                       // m, >= 0
  std::optional<double> friction;          // coefficient, >= 0; absent: that of the run
  std::optional<double> friction_static;   // >= friction; absent: friction, else that of the run
  std::optional<double> restitution;       // in [0, 1]; absent: 1
  double pressure = 0;                     // Pa, from within; other than 0 only with a closed surface
  std::vector<PressureKey> pressure_keys;  // instead, over time
  std::vector<WeightGroup> weights;        // deformable only
  std::vector<WeightShare> pressure_mix;   // factors on the pressure of triangles; none: 1
  std::vector<StiffnessWeights> stiffness_weights;  // at most one of a kind
  std::string collision_group;  // bodies of different groups do not collide; empty: of none
};

}  // namespace bb
