// A film: positions of the vertices of a mesh at times.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

/// How a film passes from frame to frame. linear: straight, with velocities that jump at frames. smooth: cubic Hermite pieces whose
/// velocity at a frame is the difference of its neighbours over their times (Catmull and Rom 1974, for times of any spacing), 0 at the
/// first and the last one.
enum class FilmInterpolation { linear, smooth };

inline std::vector<std::pair<FilmInterpolation, std::string>> words_of(FilmInterpolation) {
  return {{FilmInterpolation::linear, "linear"}, {FilmInterpolation::smooth, "smooth"}};
}

class Film {
 public:
  /// times [n] s, increasing; frames [n] of [3 x n_vertices] m. Errors: std::logic_error for fewer than two frames, or frames of
  /// different size.
  Film(std::vector<double> times, std::vector<Positions> frames, FilmInterpolation between);

  Eigen::Index n_vertices() const { return frames_.front().cols(); }
  std::size_t n_frames() const { return frames_.size(); }
  const std::vector<double>& times() const { return times_; }
  /// Where the vertex is at the time t (s): held in the first frame before, in the last one after.
  Vec3d at(Eigen::Index vertex, double t) const;
  /// Of all vertices, into columns of `out`.
  void at(double t, Eigen::Ref<Positions> out) const;
  /// Right-hand derivative of its place, m/s.
  Vec3d velocity(Eigen::Index vertex, double t) const;
  /// Every frame moves by this, m.
  Film moved(const Vec3d& by) const;

 private:
  /// Weights of frames next to each other: the place is that of frame `from`, and the weighted differences of the others to it.
  struct Blend {
    std::size_t from = 0;
    std::array<double, 4> weight = {};  // of the frames from - 1 to from + 2
  };
  Blend blend(double t) const;
  Blend rate(double t) const;
  Vec3d difference(const Blend& of, Eigen::Index vertex) const;
  std::size_t piece(double t) const;
  void add_tangent(std::size_t frame, double factor, Blend& out) const;

  std::vector<double> times_;
  std::vector<Positions> frames_;
  FilmInterpolation between_;
};

}  // namespace bb
