// Vectors as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "core/math/types.hpp"

namespace bb {

inline nlohmann::json vector_json(const Vec3d& v) { return nlohmann::json::array({v[0], v[1], v[2]}); }

}  // namespace bb
