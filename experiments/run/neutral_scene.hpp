// A scene as one JSON file for engines of others: plain numbers in SI, nothing of this program's own.
#pragma once

#include <nlohmann/json.hpp>

#include "core/terms/plan.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// barrierbench.engine_scene/1 (configs/schema/engine_scene.schema.json): start, rest, triangles, segments of rods, bodies with their materials,
/// friction, obstacles, and where prescribed vertices and obstacles that move are at the end of every step.   Errors: ConfigError for what the scene has and
/// the file cannot say.   Cost: O(vertices + triangles + prescribed vertices * steps).
nlohmann::json neutral_scene(const RunConfig& config, const Scene& scene, const Plan& plan);

}  // namespace bb
