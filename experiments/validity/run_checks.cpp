// Short runs with known ends.
#include <oneapi/tbb/global_control.h>

#include <cmath>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/base/record/provenance.hpp"
#include "experiments/validity/block.hpp"
#include "experiments/validity/small_scene.hpp"

namespace bb {
namespace {

/// Runs all steps of a small scene. Throws std::runtime_error at a step that does not converge.
const Simulation& run(Simulation& simulation, int steps, StepReport& last) {
  StepObserver nobody;
  for (int i = 0; i < steps; ++i) {
    last = simulation.step(nobody);
    if (last.status == StepStatus::converged) continue;
    throw std::runtime_error("step " + std::to_string(i) + " ended as " +
                             std::string(to_string(last.status)));
  }
  return simulation;
}

/// A triangle that comes to rest on a plane, each vertex with a third of the weight.
constexpr const char* block = R"({"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"},
  "formulation": {"shape": "log", "argument": "gap", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1000}},
  "time": {"steps": 600}, "step_solver": {"tol_velocity_m_per_s": 1e-9}})";

/// Two triangles without gravity, one flying at the other.
constexpr const char* impact = R"({"schema": "barrierbench.config/1",
  "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, 0],
    "bodies": [{"name": "still", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.1, "size_y_m": 0.1},
        "material": {"youngs_Pa": 1e5, "thickness_m": 1e-3, "density_kg_per_m2": 0.3}},
      {"name": "flying", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.1, "size_y_m": 0.1},
        "transform": {"translate_m": [0.01, 0.02, 0.02], "axis": [0, 0, 1], "angle_deg": 10}, "velocity_m_per_s": [0, 0, -1],
        "material": {"youngs_Pa": 1e5, "thickness_m": 1e-3, "density_kg_per_m2": 0.3}}]},
  "formulation": {"name": "cubic", "d_hat_m": 0.005, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1000}},
  "strain_limit": {"enabled": false},
  "step_solver": {"tol_velocity_m_per_s": 1e-12}, "time": {"dt_s": 0.002, "steps": 20}})";

Vec3d momentum(const Scene& scene, const Positions& v) {
  Vec3d sum = Vec3d::Zero();
  for (Eigen::Index i = 0; i < v.cols(); ++i) sum += scene.mass[static_cast<std::size_t>(i)] * v.col(i);
  return sum;
}

}  // namespace

void check_resting_block(BlockCheck& check) {
  for (const Shape& shape : all_shapes()) {
    if (shape.self) continue;  // of a plugin: it may have no rest
    SmallScene small(block, {"/formulation/shape=" + shape.name});
    Simulation simulation(small.scene, small.method, small.config.time.dt, small.config.time.steps);
    StepReport last;
    run(simulation, small.config.time.steps, last);
    double mass = 0;
    for (const double m : small.scene.mass) mass += m;
    const double load = mass * small.scene.gravity.norm() / small.scene.n_vertices();
    const auto rest = equilibrium(small.method.contact, 1000, small.config.formulation.d_hat, load);
    const double wanted = rest.d.value_or(std::nan(""));
    check.judge(last.gap_min_m.finite() ? std::abs(last.gap_min_m.value / wanted - 1) : HUGE_VAL, shape.name);
  }
}

void check_momentum(BlockCheck& check) {
  SmallScene small(impact);
  Simulation simulation(small.scene, small.method, small.config.time.dt, small.config.time.steps);
  const Vec3d before = momentum(small.scene, small.scene.v0);
  StepObserver nobody;
  std::size_t contacts = 0;
  for (int i = 0; i < small.config.time.steps; ++i) {
    const StepReport step = simulation.step(nobody);
    contacts += step.contacts.total();
    check.judge((momentum(small.scene, simulation.history().v) - before).norm() / before.norm(),
                "step " + std::to_string(i));
  }
  if (contacts == 0) check.detail = "the bodies never touched";
}

// Beyond 1024 vertices and elements every loop of the pipeline has work for two threads.
void check_repetition(BlockCheck& check) {
  const std::vector<std::string> large = {"/scene/bodies/0/mesh/n_x=24",
                                          "/scene/bodies/0/mesh/n_y=24",
                                          "/scene/bodies/1/mesh/n_x=24",
                                          "/scene/bodies/1/mesh/n_y=24",
                                          "/formulation/d_hat_m=0.032",
                                          "/step_solver/tol_velocity_m_per_s=1e-3",
                                          "/time/steps=1"};
  std::string first;
  for (const std::size_t threads : {1, 1, 2}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    SmallScene small(two_cloths, large);
    if (small.scene.n_vertices() <= 1024 || small.scene.membrane_triangles().size() <= 1024) {
      check.detail = "the scene is too small";
      return;
    }
    Simulation simulation(small.scene, small.method, small.config.time.dt, small.config.time.steps);
    StepReport last;
    const std::string hash = state_hash(run(simulation, small.config.time.steps, last).history().x);
    if (first.empty()) {
      first = hash;
    } else {
      check.judge(hash == first ? 0 : 1, std::to_string(threads) + " threads");
    }
  }
}

}  // namespace bb
