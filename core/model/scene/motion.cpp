#include "core/model/scene/motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace bb {
namespace {

double eased(double f, bool smooth) { return smooth ? f * f * (3 - 2 * f) : f; }

/// The pose of keyframes at the time t.
Keyframe pose_at(const std::vector<Keyframe>& keys, double t, bool smooth) {
  const auto next = std::find_if(keys.begin(), keys.end(), [t](const Keyframe& k) { return k.time > t; });
  if (next == keys.begin()) return keys.front();
  if (next == keys.end()) return keys.back();
  const Keyframe &from = *(next - 1), &to = *next;
  const double f = eased((t - from.time) / (to.time - from.time), smooth);
  return {t, from.translation + f * (to.translation - from.translation),
          from.angle + f * (to.angle - from.angle), from.scale + f * (to.scale - from.scale)};
}

bool same_key(const Keyframe& a, const Keyframe& b) {
  return a.time == b.time && a.translation == b.translation && a.angle == b.angle && a.scale == b.scale;
}

bool same_step(const MotionStep& a, const MotionStep& b) {
  return a.velocity == b.velocity && a.center == b.center && a.axis == b.axis &&
         a.angular_velocity == b.angular_velocity && a.start == b.start && a.end == b.end &&
         a.scale == b.scale && a.smooth == b.smooth &&
         std::equal(a.keyframes.begin(), a.keyframes.end(), b.keyframes.begin(), b.keyframes.end(), same_key);
}

}  // namespace

bool MotionStep::is_static() const {
  return velocity.isZero(0) && angular_velocity == 0 && scale == 1 && keyframes.empty();
}

/// What it makes of every point by the time t.
Keyframe MotionStep::pose(double t) const {
  if (!keyframes.empty()) return pose_at(keyframes, t, smooth);
  double s = std::clamp(t, start, end) - start;  // s, of the way that is gone
  if (smooth && end > start) s = eased(s / (end - start), true) * (end - start);
  const double grown = scale == 1 ? 1 : 1 + (scale - 1) * (s / (end - start));
  return {t, velocity * s, angular_velocity * s, grown};
}

Vec3d MotionStep::operator()(const Vec3d& x, double t) const {
  if (is_static()) return x;
  const Keyframe at = pose(t);
  const bool turns = keyframes.empty() ? angular_velocity != 0 : at.angle != 0;
  if (!turns && at.scale == 1) return x + at.translation;  // exact where nothing turns
  const Eigen::AngleAxisd turn(at.angle, axis);
  if (at.scale == 1) return center + turn * (x - center) + at.translation;
  return center + at.scale * (turn * (x - center)) + at.translation;
}

Mat3d MotionStep::turn(double t) const { return Eigen::AngleAxisd(pose(t).angle, axis).toRotationMatrix(); }

Vec3d MotionStep::start_velocity(const Vec3d& x) const {
  Vec3d way = velocity;  // per second, as are the next two
  double turning = angular_velocity, growing = 0;
  if (!keyframes.empty()) {
    const auto next =
        std::find_if(keyframes.begin(), keyframes.end(), [](const Keyframe& k) { return k.time > 0; });
    if (smooth || next == keyframes.begin() || next == keyframes.end()) return Vec3d::Zero();
    const Keyframe &from = *(next - 1), &to = *next;
    const double length = to.time - from.time;
    way = (to.translation - from.translation) / length;
    turning = (to.angle - from.angle) / length;
    growing = (to.scale - from.scale) / length;
  } else {
    if (start > 0 || end <= 0 || smooth) return Vec3d::Zero();
    if (scale != 1) growing = (scale - 1) / (end - start);
  }
  const Vec3d turned = way + turning * axis.cross(Vec3d(x - center));
  return growing == 0 ? turned : Vec3d(turned + growing * (x - center));
}

double MotionStep::most_turning() const {
  const double most = smooth ? 1.5 : 1;  // slope of 3 f^2 - 2 f^3
  double out = keyframes.empty() ? std::abs(angular_velocity) : 0;
  for (std::size_t k = 1; k < keyframes.size(); ++k) {
    const double length = keyframes[k].time - keyframes[k - 1].time;
    out = std::max(out, std::abs(keyframes[k].angle - keyframes[k - 1].angle) / length);
  }
  return most * out;
}

bool MotionStep::changes_size() const {
  return scale != 1 ||
         std::any_of(keyframes.begin(), keyframes.end(), [](const Keyframe& k) { return k.scale != 1; });
}

bool MotionStep::begins_at_start() const {
  const Keyframe at = pose(0);
  return at.translation.isZero(0) && at.angle == 0 && at.scale == 1;
}

double MotionStep::last_change() const {
  if (!keyframes.empty()) return keyframes.back().time;
  return is_static() ? 0 : end;
}

bool PrescribedMotion::is_static() const {
  bool all = !film;
  for_each_step([&all](const MotionStep& step) { all = all && step.is_static(); });
  return all;
}

Vec3d PrescribedMotion::pose(int vertex, const Vec3d& x, double t) const {
  Vec3d out = film ? film->at(vertex - first_vertex, t) : x;
  for_each_step([&out, t](const MotionStep& step) { out = step(out, t); });
  return out;
}

Mat3d PrescribedMotion::turn(double t) const {
  Mat3d out = MotionStep::turn(t);
  for (const MotionStep& step : then) out = step.turn(t) * out;
  return out;
}

Vec3d PrescribedMotion::start_velocity(int vertex, const Vec3d& x) const {
  Vec3d sum = MotionStep::start_velocity(x);  // every operation begins with the identity
  for (const MotionStep& step : then) sum += step.start_velocity(x);
  return film ? Vec3d(sum + film->velocity(vertex - first_vertex, 0)) : sum;
}

double PrescribedMotion::most_turning() const {
  double sum = 0;
  for_each_step([&sum](const MotionStep& step) { sum += step.most_turning(); });
  return sum;
}

bool PrescribedMotion::changes_size() const {
  bool any = film != nullptr;
  for_each_step([&any](const MotionStep& step) { any = any || step.changes_size(); });
  return any;
}

double PrescribedMotion::last_change() const {
  double last = film ? film->times().back() : 0;
  for_each_step([&last](const MotionStep& step) { last = std::max(last, step.last_change()); });
  return last;
}

void PrescribedMotion::translate(const Vec3d& by) {
  if (film) film = std::make_shared<const Film>(film->moved(by));
  center += by;
  for (MotionStep& step : then) step.center += by;
}

bool same_motion(const PrescribedMotion& a, const PrescribedMotion& b) {
  if (a.is_static() && b.is_static()) return true;
  if (a.film != b.film || (a.film && a.first_vertex != b.first_vertex)) return false;
  return same_step(a, b) && std::equal(a.then.begin(), a.then.end(), b.then.begin(), b.then.end(), same_step);
}

}  // namespace bb
