// A scene that every check of assembly and runs shares, and its simulation.
#pragma once

#include <string>

#include "core/step_solvers/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/method.hpp"

namespace bb {

/// A config, its scene and its method, with the stiffness as given.
struct SmallScene {
  RunConfig config;
  Scene scene;
  Method method;

  explicit SmallScene(const std::string& text, const std::vector<std::string>& overrides = {})
      : config(parse_config(text, "validity block", ".", overrides)),
        scene(build_scene(config)),
        method(make_method(config, {})) {}
};

/// Two cloths of 16 vertices, one close above the other, over a floor; every vertex of the lower one in contact.
inline constexpr const char* two_cloths = R"({"schema": "barrierbench.config/1",
  "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -10],
    "bodies": [{"name": "lower", "mesh": {"generator": "grid", "n_x": 4, "n_y": 4, "size_x_m": 1, "size_y_m": 1},
        "transform": {"translate_m": [0, 0, 0.02]},
        "material": {"youngs_Pa": 2e4, "thickness_m": 1e-3, "density_kg_per_m2": 0.3, "bending_J": 0.01}},
      {"name": "upper", "mesh": {"generator": "grid", "n_x": 4, "n_y": 4, "size_x_m": 0.9, "size_y_m": 0.9},
        "transform": {"translate_m": [0.04, 0.07, 0.05], "axis": [0, 0, 1], "angle_deg": 20},
        "material": {"youngs_Pa": 2e4, "thickness_m": 1e-3, "density_kg_per_m2": 0.3, "bending_J": 0.01}}],
    "obstacles": [{"name": "floor", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 0, 1]}]},
  "formulation": {"name": "log", "d_hat_m": 0.05, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 40}},
  "strain_limit": {"enabled": false}, "time": {"dt_s": 0.01, "steps": 5}, "threads": 1})";

}  // namespace bb
