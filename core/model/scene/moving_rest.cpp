#include "core/model/scene/moving_rest.hpp"

namespace bb {

const Positions& MovingRest::at(double t) {
  if (t == time_) return x_;
  time_ = t;
  x_ = scene_->rest;
  for (const RestMotion& motion : scene_->rest_motions) {
    auto own = x_.middleCols(motion.first_vertex, motion.n_vertices);
    if (motion.film) motion.film->at(t, own);
    if (!motion.factors.empty()) own *= value_at(motion.factors, t);
  }
  return x_;
}

}  // namespace bb
