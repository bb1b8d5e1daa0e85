// Configs that are matched, and what their calibration runs carried: shared by the tests of matching.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"
#include "experiments/run/calibration_run.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::test {

/// The block of 0.3 kg on its three corners, already in contact: every number can be written down.
inline constexpr const char* block =
    R"({"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"},
  "formulation": {"name": "cubic_dynamic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force"},
  "time": {"steps": 20}})";

/// A cloth whose own d_hat is not the formulation's, dropped on a plane that it meets after some steps.
inline constexpr const char* falling = R"({"schema": "barrierbench.config/1",
  "scene": {"bodies": [{"name": "cloth", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "d_hat_m": 0.004,
                        "transform": {"translate_m": [0, 0, 0.03]}}],
            "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
  "formulation": {"name": "cubic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force"},
  "time": {"dt_s": 0.01, "steps": 20}})";

/// Two cloths without stiffness against the normal fall on a plane: the heavy one has the largest load, the
/// light and fast one the largest load for its mass.
inline constexpr const char* two_masses = R"({"schema": "barrierbench.config/1",
  "scene": {"bodies": [{"name": "heavy", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2}, "material": {"density_kg_per_m2": 2},
                        "velocity_m_per_s": [0, 0, -0.1], "transform": {"translate_m": [0, 0, 0.015]}},
                       {"name": "light", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2}, "material": {"density_kg_per_m2": 0.2},
                        "velocity_m_per_s": [0, 0, -2], "transform": {"translate_m": [3, 0, 0.0115]}}],
            "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
  "formulation": {"name": "cubic_dynamic_lagged", "d_hat_m": 0.01,
                  "stiffness_policy": {"name": "elasticity_inclusive", "elastic_term": false, "refresh": "per_step"}},
  "matching": {"rule": "equal_force"}, "time": {"dt_s": 0.01, "steps": 12}})";

/// A cloth that hangs from two corners, its limit stiff by elasticity.
inline constexpr const char* hanging =
    R"({"schema": "barrierbench.config/1", "scene": {"name": "hang", "n": 4},
  "formulation": "cubic_dynamic", "matching": {"rule": "equal_force"}, "strain_limit": {"limit": 0.01},
  "time": {"steps": 25}})";

inline RunConfig parsed(const char* text, const std::vector<std::string>& overrides) {
  return parse_config(text, "test", ".", overrides);
}

struct Calibrated {
  RunConfig config;
  Scene scene;
  MatchingRecord record;
  Calibration calibration;
};

inline Calibrated calibrated(const char* text, const std::vector<std::string>& overrides = {}) {
  Calibrated out{parsed(text, overrides), {}, {}, {}};
  out.scene = build_scene(out.config);
  out.calibration = calibrate(out.config, out.scene, {}, out.record);
  return out;
}

inline double slope(const char* shape, double d, double d_hat) {
  return -BarrierFunction{require_shape(shape), Argument::gap}.eval(d, d_hat).db;
}

inline RunRecord run(const RunConfig& config) {
  RunOptions options;
  const TemporaryFolder folder;
  options.folder = folder;
  return run_config(config, options);
}

/// A load of the calibration run and the vertex that carried it, on the plane z = 0.
struct VertexLoad {
  double load, mass, d_hat;  // N, kg, m
  int body;
  std::size_t step;
};

/// Every load over the converged step ends of the calibration run.
inline std::vector<VertexLoad> loads_on_plane(const Calibrated& c) {
  const std::shared_ptr<const CalibrationRun> kept = run_calibration(c.config, c.scene, {});
  const CalibrationRun& calibration_run = *kept;
  std::vector<VertexLoad> out;
  for (std::size_t step = 1; step < calibration_run.x.size(); ++step) {
    for (int v = 0; v < c.scene.n_vertices(); ++v) {
      const auto i = static_cast<std::size_t>(v);
      const double d = calibration_run.x[step](2, v), d_hat = c.scene.d_hat[i];
      if (d >= d_hat) continue;
      out.push_back({*calibration_run.stiffness.kappa * -log_barrier().eval(d, d_hat).db, c.scene.mass[i],
                     d_hat, c.scene.body[i], step - 1});
    }
  }
  return out;
}

/// The smallest that a policy kappa = m/d^2 can be inside the support: at d_hat.
inline double softest(double mass, double d_hat) { return mass / (d_hat * d_hat); }

}  // namespace bb::test
