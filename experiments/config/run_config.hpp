// Everything one run is made of, as plain values with every default filled in. No JSON here: parse.hpp reads
// and writes it. Member names are the JSON keys without their unit suffix; units stand behind each member.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/bodies/body_spec.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/linear/condition.hpp"
#include "core/linear/linear_solver.hpp"
#include "experiments/scenes/parameters.hpp"

namespace bb {

/// Where a mesh comes from: a generator with its parameters, or a file with its SHA-256.
struct MeshSource {
  std::string generator;    // empty when `file` is set
  ParameterMap parameters;  // of the generator, complete
  std::string file;         // absolute path
  std::string sha256;       // of the file's bytes, hex
};

/// Applied to mesh vertices in this order: scale, rotation about the axis through the origin, translation.
struct TransformConfig {
  double scale = 1;
  Vec3d axis = Vec3d::UnitZ();
  double angle = 0;                   // degrees
  Vec3d translation = Vec3d::Zero();  // m
};

/// A body of a scene given as JSON; `spec.mesh` is empty until build_scene reads or generates it.
struct BodyConfig {
  MeshSource mesh;
  TransformConfig transform;
  BodySpec spec;        // without mesh; d_hat 0 means formulation.d_hat
  bool limited = true;  // subject to strain_limit
};

struct SceneConfig {
  std::string name;                             // registered scene, or "bodies"
  ParameterMap parameters;                      // registered scene: every declared parameter
  bool planar = false;                          // as the registered scene says, or as given with bodies
  Vec3d gravity = Vec3d(0, 0, -9.81);           // m/s^2; registered scene: from its parameter
  PlanarPairs pairs = PlanarPairs::point_edge;  // "bodies" only, like all that follows
  std::vector<BodyConfig> bodies;
  std::vector<Obstacle> obstacles;
};

/// Contact stiffness policy, or the limit's. For the limit `fixed` reads k_s, not kappa.
struct PolicyConfig {
  std::string name = "fixed";
  std::optional<double> kappa;  // N/m; fixed. Absent: the matching rule supplies it
  std::optional<double> k_s;    // N/m; fixed, strain limit only. Absent: the matching rule supplies it
  double scale = 1;             // factor on every kappa of the policy
  MassTerm mass_term = MassTerm::paper;        // elasticity_inclusive
  bool elastic_term = true;                    // elasticity_inclusive
  Refresh refresh = Refresh::per_iteration;    // elasticity_inclusive
  std::optional<double> kappa_min, kappa_max;  // N/m, ipc_adaptive: bounds instead of the policy's own
  std::optional<double> doubling_gap;          // m, ipc_adaptive: instead of the policy's own
};

struct FormulationConfig {
  std::string name;  // preset it came from, or empty
  std::string shape = "log";
  Argument argument = Argument::gap;
  PolicyConfig stiffness_policy;
  double d_hat = 1e-2;  // m
};

struct StrainLimitConfig {
  bool enabled = false;
  std::string shape = "log";
  Argument argument = Argument::gap;
  PolicyConfig stiffness_policy;
  StrainLimitSpec limit;  // onset and width, 1
};

enum class MatchingRule { as_given, equal_force, equal_curvature };
inline const char* to_string(MatchingRule rule) {
  constexpr const char* names[] = {"as_given", "equal_force", "equal_curvature"};
  return names[static_cast<int>(rule)];
}

/// docs/design.md, Matching. What is absent and needed is found by a pilot run.
struct MatchingConfig {
  MatchingRule rule = MatchingRule::as_given;
  double theta = 0.1;                     // gap / d_hat at which forces are equal
  std::optional<double> load;             // N
  std::optional<double> limit_load;       // N/m
  std::optional<double> curvature;        // N/m, equal_curvature
  std::optional<double> limit_curvature;  // N/m, equal_curvature
};

struct ContactConfig {
  Mollifier mollifier = Mollifier::ipc;
  HessianMode hessian_mode = HessianMode::gauss_newton;
  double ccd_park = 1e-6;  // units of d_hat
};

struct TimeConfig {
  double dt = 0.01;  // s
  int steps = 40;
};

struct StepSolverConfig {
  std::string name = "line_search";  // line_search, accumulated_toi, article_literal
  int max_iterations = 500;
  double tol_velocity = 1e-4;  // m/s, |dx|_inf / dt; default 1e-4 d_hat/dt
  double armijo = 1e-4;
  double cap_fraction = 0.8;
  double target_toi = 0.25;  // accumulated_toi
  int min_newton_steps = 1;  // accumulated_toi
};

struct PassesConfig {
  bool time = true, diagnose = false, audit = true;
};

struct DiagnoseConfig {
  int tier = 2;
  std::vector<Scaling> scalings = {Scaling::none, Scaling::jacobi, Scaling::block_jacobi};
  int every = 1;                               // Newton iterations
  std::vector<std::string> stages = {"full"};  // full, without_contact, without_contact_and_limit
  std::uint64_t seed = 1;                      // of the start vector
  bool pcg = true;                             // probe every diagnosed matrix with block-Jacobi PCG
  double budget = 0;                           // s over the whole run, 0: no bound
};

struct SeedsConfig {
  std::uint64_t main = 1;
  double jitter = 0;  // m, uniform in [-jitter, jitter] on each start coordinate of free vertices
};

struct OutputConfig {
  int frames_every = 0;   // steps, 0: none
  bool matrices = false;  // the matrix of every diagnosed iteration
};

struct RunConfig {
  std::string source;  // file it came from, for messages; not part of config_id
  SceneConfig scene;
  FormulationConfig formulation;
  StrainLimitConfig strain_limit;
  MatchingConfig matching;
  ContactConfig contact;
  std::string integrator = "implicit_euler";
  TimeConfig time;
  StepSolverConfig step_solver;
  LinearOptions linear_solver;
  std::string precision = "double";
  PassesConfig passes;
  DiagnoseConfig diagnose;
  SeedsConfig seeds;
  OutputConfig output;
  int threads = 0;  // 0: all cores
};

}  // namespace bb
