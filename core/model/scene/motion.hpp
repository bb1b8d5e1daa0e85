// Motions that are given as functions of time: films, rates, keyframes, operations one after the other; and numbers that
// follow keys.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "core/math/types.hpp"
#include "core/model/scene/film_source.hpp"

namespace bb {

/// Where a motion is at a time: scaled and turned about its centre, then moved.
struct Keyframe {
  double time = 0;                    // s
  Vec3d translation = Vec3d::Zero();  // m
  double angle = 0;                   // rad, about the axis of the motion
  double scale = 1;                   // > 0
};

/// One operation: x -> c + g R(angle) (x - c) + way. With keyframes they say g, angle and way, constant before the first and
/// after the last. Without, from start to end the way grows by velocity, the angle by angular_velocity, and g goes from 1 to
/// `scale`; nothing changes before and after. smooth: each of these stretches is gone through as 3 f^2 - 2 f^3, f the part
/// of its time that is over, instead of f.
struct MotionStep {
  Vec3d velocity = Vec3d::Zero();                        // m/s
  Vec3d center = Vec3d::Zero();                          // m
  Vec3d axis = Vec3d::UnitZ();                           // unit
  double angular_velocity = 0;                           // rad/s
  double start = 0;                                      // s
  double end = std::numeric_limits<double>::infinity();  // s
  double scale = 1;                                      // factor that is reached at the end
  bool smooth = false;
  std::vector<Keyframe> keyframes = {};  // times increasing

  bool is_static() const;
  /// Where it takes x by the time t (s).
  Vec3d operator()(const Vec3d& x, double t) const;
  /// R(angle) at the time t (s).
  Mat3d turn(double t) const;
  /// Velocity of a point that is at x at the time 0, m/s, as long as the motion has not begun before.
  Vec3d start_velocity(const Vec3d& x) const;
  /// The largest |angular velocity|, rad/s.
  double most_turning() const;
  bool changes_size() const;
  /// At the time 0 every point is where it starts.
  bool begins_at_start() const;
  /// From when on nothing changes, s.
  double last_change() const;

 private:
  Keyframe pose(double t) const;
};

/// Motion of prescribed vertices: a film, where there is one, then its own operation, then those of `then`, each applied to what the ones
/// before make of x.
struct PrescribedMotion : MotionStep {
  std::vector<MotionStep> then = {};
  FilmSource film_source = {};
  std::shared_ptr<const Film> film =
      nullptr;  // of film_source; its vertex 0 is that of the scene's first_vertex
  int first_vertex = 0;

  /// f(step) of every operation, in their order.
  template <class F>
  void for_each_step(const F& f) const {
    f(static_cast<const MotionStep&>(*this));
    for (const MotionStep& step : then) f(step);
  }
  bool is_static() const;
  Vec3d operator()(const Vec3d& x, double t) const = delete;  // its own operation alone
  /// Where the vertex of the scene that starts at x is at the time t (s).
  Vec3d pose(int vertex, const Vec3d& x, double t) const;
  Mat3d turn(double t) const;  // of all operations
  /// As that of an operation.
  Vec3d start_velocity(int vertex, const Vec3d& x) const;
  double most_turning() const;  // rad/s, of all operations together
  bool changes_size() const;    // or shape
  double last_change() const;
  /// Every centre, and every frame of the film, moves by this, m.
  void translate(const Vec3d& by);
};

/// Every number equal and the same film, or both static.
bool same_motion(const PrescribedMotion& a, const PrescribedMotion& b);

/// A value that is given at times, s, which increase: linear between them, constant before the first and after the last.
/// K has members time and value. Requires a key.
template <class K>
auto value_at(const std::vector<K>& keys, double t) {
  std::size_t next = 0;
  while (next < keys.size() && keys[next].time <= t) ++next;
  using Value = decltype(K::value);
  if (next == 0) return keys.front().value;
  if (next == keys.size()) return keys.back().value;
  const K &from = keys[next - 1], &to = keys[next];
  return Value(from.value + (t - from.time) / (to.time - from.time) * (to.value - from.value));
}

}  // namespace bb
