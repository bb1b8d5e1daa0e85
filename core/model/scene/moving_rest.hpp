// What the rest shapes of a scene are at a time.
#pragma once

#include <limits>

#include "core/model/scene/scene.hpp"

namespace bb {

class MovingRest {
 public:
  /// Rest shapes that stay.
  MovingRest() = default;
  /// Those of a scene, which outlives it.
  explicit MovingRest(const Scene& scene) : scene_(scene.rest_motions.empty() ? nullptr : &scene) {}

  bool moves() const { return scene_ != nullptr; }
  /// Scene::rest. Requires moves().
  const Positions& start() const { return scene_->rest; }
  /// Positions [3 x n_vertices] (m) whose lengths and angles are those at rest at the time t (s); valid until the next call.
  /// Requires moves(). Cost: O(n) where the time is another than that of the last call.
  const Positions& at(double t);

 private:
  const Scene* scene_ = nullptr;
  Positions x_;
  double time_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace bb
