// What a scene may have, on a case whose answer is known: the rows of the table feature x step solver x integrator
// (docs/step_solver_features.md). A feature says its case for any step solver and integrator, and what its answer has to be.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/integrators/registry.hpp"
#include "core/model/scene/scene.hpp"
#include "core/newton/step_solver.hpp"

namespace bb::features {

constexpr double g = 9.81;  // m/s^2

/// A column of the table.
struct Method {
  const StepSolverEntry& solver;
  const IntegratorEntry& entry;
  std::shared_ptr<const Integrator> integrator;

  bool still() const { return integrator->quasi_static(); }
  /// The part of the weight that acts.
  double weight() const { return integrator->weight_factor(); }
};

/// All states of a run, the start first.
struct Track {
  Scene scene;
  double dt = 0;                // s
  std::vector<double> t;        // s
  std::vector<Positions> x, v;  // m, m/s

  const Positions& end() const { return x.back(); }
  double t_end() const { return t.back(); }
  /// Of the centre of mass of the free vertices, m/s.
  Vec3d velocity(std::size_t step) const;
  /// The state at the first step end that is at `time` (s) or later.
  std::size_t at(double time) const;
};

struct Feature {
  std::string name;
  std::string answer;                   // what is known of the case, in words
  std::vector<std::string_view> terms;  // of E that it needs
  bool needs_inertia;                   // an integrator without inertia has no case of it
  std::function<nlohmann::json(const Method&)> config;
  /// What is wrong with a run of the config; empty: nothing.
  std::function<std::string(const Method&, const Track&)> wrong;
};

/// All of them.
std::vector<Feature> features();
std::vector<Feature> contact_features();
std::vector<Feature> friction_features();
std::vector<Feature> load_features();
std::vector<Feature> stitch_features();
std::vector<Feature> prescribed_features();
/// One for every part that bodies are made of, and what parts can have besides.
std::vector<Feature> part_features();

/// A config without a feature: a plate of springs, 0.1 m x 0.1 m, 1 kg, nothing that acts on it.
nlohmann::json bare(const Method& method, double dt, int steps);
nlohmann::json plate(const std::string& name, double height, double velocity_z = 0);
void add_floor(nlohmann::json& config);
/// A plate on a floor, near the gap at which a barrier carries it.
nlohmann::json on_the_floor(const Method& method, double dt, int steps);
/// Where nothing holds a body by its inertia, springs of `stiffness` (N/m) pull each of its vertices to its start.
void ground(const Method& method, nlohmann::json& config, double stiffness);

/// Runs a config. Errors: ConfigError where it is refused.
struct Outcome {
  Track track;
  std::string failed;  // how it ended, where that is not ok
  std::vector<std::string> terms;
};
Outcome run_case(const nlohmann::json& config);

/// "NAME is A, not B", or nothing where |A - B| <= tolerance.
std::string differs(const char* name, double found, double expected, double tolerance);

}  // namespace bb::features
