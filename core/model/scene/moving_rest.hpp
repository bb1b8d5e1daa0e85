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
  explicit MovingRest(const Scene& scene);

  bool moves() const { return scene_ != nullptr; }
  /// Scene::rest. Requires moves().
  const Positions& start() const { return scene_->rest; }
  /// To the time t (s). Returns whether now() may have changed, true at the first call. Cost: O(n) where it does; nothing after the last
  /// key and frame.
  bool move(double t);
  /// Positions [3 x n_vertices] (m) whose lengths and angles are those at rest. Requires moves(), and that move() was called.
  const Positions& now() const { return x_; }

 private:
  const Scene* scene_ = nullptr;
  Positions x_;
  double last_ = 0;  // s, from when on nothing changes
  double time_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace bb
