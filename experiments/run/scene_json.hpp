// What files about a scene have in common, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "core/model/scene/scene.hpp"

namespace bb {

inline nlohmann::json vector_json(const Vec3d& v) { return nlohmann::json::array({v[0], v[1], v[2]}); }

/// Name, kind and shape; a plane has no radius and no inside.
inline nlohmann::json obstacle_json(const Obstacle& o) {
  constexpr const char* kinds[] = {"plane", "sphere", "cylinder"};
  nlohmann::json out = {
      {"name", o.name}, {"kind", kinds[static_cast<int>(o.kind)]}, {"point_m", vector_json(o.point)}};
  if (o.kind != ObstacleKind::sphere) out["axis"] = vector_json(o.axis);
  if (o.kind != ObstacleKind::plane) out.update({{"radius_m", o.radius}, {"inside", o.inside}});
  return out;
}

}  // namespace bb
