// The pose of prescribed vertices.
#include <Eigen/Geometry>
#include <algorithm>

#include "core/scene/scene.hpp"

namespace bb {

Mat3d RigidMotion::turn(double t) const {
  const double s = std::clamp(t, start, end) - start;
  return Eigen::AngleAxisd(angular_velocity * s, axis).toRotationMatrix();
}

Vec3d pin_pose(const Scene& scene, const Pin& pin, double t) {
  const RigidMotion& motion = scene.motions[static_cast<std::size_t>(pin.motion)];
  Vec3d x0 = scene.x0.col(pin.vertex);
  if (motion.is_static()) return x0;
  const double s = std::clamp(t, motion.start, motion.end) - motion.start;
  if (motion.angular_velocity == 0) return x0 + motion.velocity * s;  // exact where nothing turns
  const Eigen::AngleAxisd turn(motion.angular_velocity * s, motion.axis);
  return motion.center + turn * (x0 - motion.center) + motion.velocity * s;
}

}  // namespace bb
