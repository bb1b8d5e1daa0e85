// Everything one run is made of, as plain values with every default filled in. No JSON here: parse.hpp reads
// and writes it. The sections are made from the lines of settings.inc; there each member has its unit,
// default and meaning.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "barriers/stiffness/registry.hpp"
#include "core/barrier/shape.hpp"
#include "core/base/parameters/parameter.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/linear/condition.hpp"
#include "core/math/precision.hpp"
#include "core/model/bodies/body_spec.hpp"
#include "core/newton/saddle_rule.hpp"
#include "core/newton/step_size.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// Where a run computes. cpu: the pipeline of core/newton. host: the device backend on threads of this
/// machine, the same kernels as on a device. cuda: on a device.
enum class Device { cpu, host, cuda };

enum class MatchingRule { as_given, equal_force, equal_curvature };
inline const char* to_string(MatchingRule rule) {
  constexpr const char* names[] = {"as_given", "equal_force", "equal_curvature"};
  return names[static_cast<int>(rule)];
}

#define SECTION(type, doc) struct type {
#define SETTING(type, member, name, rule, doc, ...) type member = __VA_ARGS__;
#define NEST(type, member, name, settings) type member;
#define OWN(...) ParameterMap parameters;
#define END_SECTION \
  }                 \
  ;
#include "experiments/config/settings.inc"

/// Where a mesh comes from: a generator with its parameters, or a file with its SHA-256.
struct MeshSource {
  std::string generator;             // empty when `file` is set
  ParameterMap parameters;           // of the generator, complete
  std::string file;                  // absolute path
  std::string sha256;                // of the file's bytes, hex
  std::vector<std::string> objects;  // of the file, these alone; none: all of it

  bool given() const { return !generator.empty() || !file.empty(); }
};

/// Vertices in a closed box (min, max) of start positions have this weight.
struct WeightBox {
  std::optional<std::array<Vec3d, 2>> box;  // m
  double weight = 1;
};
/// A weight group of a body: numbers of a file, of boxes, of a formula, or that rise along an axis.
struct WeightGroupConfig {
  std::string name;
  HashedFile file;               // none: empty path
  std::string formula;           // in x, y, z (m); none: empty
  std::vector<WeightBox> boxes;  // the last one counts; outside of all 0
  Vec3d axis = Vec3d::UnitX();
  std::optional<double> from, to;  // m along the axis: 0 there, 1 here, linear between
};

/// A body of a scene given as JSON; `spec.mesh` is empty until build_scene reads or generates it.
struct BodyConfig {
  MeshSource mesh;
  MeshSource rest_mesh;  // whose vertices are the rest shape; none: those of mesh
  FilmSource rest_film;  // the same over time; none: they stay
  TransformConfig transform;
  std::vector<WeightGroupConfig> weights;
  BodySpec spec;                // without mesh, weights and d_hat
  std::optional<double> d_hat;  // m; absent: formulation.d_hat
  bool limited = true;          // subject to strain_limit
};

/// The films of a body, of its motion, of the motions of its pins and of its rest shape, given or not.
template <class Body>
auto films_of(Body& body) {
  std::vector<decltype(&body.rest_film)> out{&body.rest_film, &body.spec.motion.film_source};
  for (auto& pin : body.spec.pins) out.push_back(&pin.motion.film_source);
  return out;
}

struct SceneConfig {
  std::string name;                             // registered scene, or "bodies"
  ParameterMap parameters;                      // registered scene: every declared parameter
  bool planar = false;                          // as the registered scene states, or as given with bodies
  Vec3d gravity = Vec3d(0, 0, -9.81);           // m/s^2; registered scene: from its parameter
  Vec3d translation = Vec3d::Zero();            // m, of all that has a place, after the scene is made
  PlanarPairs pairs = PlanarPairs::point_edge;  // "bodies" only, like all that follows
  std::vector<GravityKey> gravity_keys;         // instead of gravity, which is its first value
  Air air;
  VelocityDamping damping;
  std::vector<BodyConfig> bodies;
  std::vector<StitchSpec> stitches;
  std::vector<Obstacle> obstacles;
  std::vector<CollisionSpec> collisions;
};

/// Its name, or that of its shape where it has none.
inline const std::string& label_of(const FormulationConfig& formulation) {
  return formulation.name.empty() ? formulation.shape : formulation.name;
}

/// Where a run ends, s.
inline double end_time(const TimeConfig& time) { return time.duration.value_or(time.dt * time.steps); }

struct RunConfig {
  std::string source;  // file it came from, for messages; not part of config_id
  std::string name;    // free label, for tables; not part of config_id
  std::string linear_solver_reason = "as requested";  // or why auto chose it; no setting
  std::string method;                                 // published method that was requested; empty: none
  SceneConfig scene;
  FormulationConfig formulation;
  StrainLimitConfig strain_limit;
  MatchingConfig matching;
  ContactConfig contact;
  FrictionConfig friction;
  IntegratorConfig integrator;
  TimeConfig time;
  StepSolverConfig step_solver;
  HessianConfig hessian;
  LinearSolverConfig linear_solver;
  Precision precision = Precision::full;
  Device device = Device::cpu;
  PassesConfig passes;
  DiagnoseConfig diagnose;
  SeedsConfig seeds;
  OutputConfig output;
  int threads = 0;  // 0: all cores
};

}  // namespace bb
