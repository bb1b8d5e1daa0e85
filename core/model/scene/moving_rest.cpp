#include "core/model/scene/moving_rest.hpp"

#include <algorithm>

namespace bb {

MovingRest::MovingRest(const Scene& scene) : scene_(scene.rest_motions.empty() ? nullptr : &scene) {
  for (const RestMotion& motion : scene.rest_motions) {
    if (motion.film) last_ = std::max(last_, motion.film->times().back());
    if (!motion.factors.empty()) last_ = std::max(last_, motion.factors.back().time);
  }
}

bool MovingRest::move(double t) {
  t = std::min(t, last_);
  if (!moves() || t == time_) return false;
  time_ = t;
  x_ = scene_->rest;
  for (const RestMotion& motion : scene_->rest_motions) {
    auto own = x_.middleCols(motion.first_vertex, motion.n_vertices);
    if (motion.film) motion.film->at(t, own);
    if (!motion.factors.empty()) own *= value_at(motion.factors, t);
  }
  return true;
}

}  // namespace bb
