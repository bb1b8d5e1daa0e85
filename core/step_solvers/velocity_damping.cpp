#include "core/step_solvers/velocity_damping.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact/obstacle.hpp"

namespace bb {

void damp_velocities(const Scene& scene, const PositionsView& x, double dt, Positions& v) {
  const VelocityDamping& damping = scene.damping;
  if (!damping.acts()) return;
  const double everywhere = std::pow(damping.factor, dt);
  const double near = std::pow(damping.near_obstacles.value_or(damping.factor), dt);
  std::vector<AnalyticSurface<double>> obstacles;
  if (near != everywhere) {
    for (const Obstacle& o : scene.obstacles) obstacles.push_back(posed(analytic_surface<double>(o), x));
  }
  for (Eigen::Index i = 0; i < v.cols(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(scene.mass[k] > 0)) continue;
    const bool at_one = std::any_of(obstacles.begin(), obstacles.end(), [&](const auto& o) {
      return surface_gap<double>(o, x.col(i)).d - scene.offset[k] < scene.d_hat[k];
    });
    v.col(i) *= at_one ? near : everywhere;
  }
}

}  // namespace bb
