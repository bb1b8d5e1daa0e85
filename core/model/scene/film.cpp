#include "core/model/scene/film.hpp"

#include <algorithm>
#include <stdexcept>

namespace bb {

Film::Film(std::vector<double> times, std::vector<Positions> frames, FilmInterpolation between)
    : times_(std::move(times)), frames_(std::move(frames)), between_(between) {
  const bool same_size = std::all_of(frames_.begin(), frames_.end(), [this](const Positions& frame) {
    return frame.cols() == frames_.front().cols();
  });
  if (frames_.size() < 2 || times_.size() != frames_.size() || !same_size) {
    throw std::logic_error("a film has two frames of one size or more, and a time of each");
  }
}

/// The frame before t, where one follows.
std::size_t Film::piece(double t) const {
  const auto next = std::upper_bound(times_.begin(), times_.end(), t);
  const auto before = static_cast<std::size_t>(next - times_.begin()) - 1;
  return std::min(before, times_.size() - 2);
}

/// factor times the velocity at a frame, which is 0 at both ends.
void Film::add_tangent(std::size_t frame, double factor, Blend& out) const {
  if (frame == 0 || frame + 1 == times_.size()) return;
  const double by = factor / (times_[frame + 1] - times_[frame - 1]);
  const std::size_t at = frame + 1 - out.from;  // of weight: 1 is `from`
  out.weight[at + 1] += by;
  out.weight[at - 1] -= by;
}

Film::Blend Film::blend(double t) const {
  if (t <= times_.front()) return {};
  if (t >= times_.back()) return {times_.size() - 1, {}};
  Blend out{piece(t), {}};
  const double length = times_[out.from + 1] - times_[out.from], f = (t - times_[out.from]) / length;
  if (between_ == FilmInterpolation::linear) {
    out.weight[2] = f;
    return out;
  }
  out.weight[2] = f * f * (3 - 2 * f);
  add_tangent(out.from, length * f * (1 - f) * (1 - f), out);
  add_tangent(out.from + 1, -length * f * f * (1 - f), out);
  return out;
}

Film::Blend Film::rate(double t) const {
  if (t < times_.front() || t >= times_.back()) return {};
  Blend out{piece(t), {}};
  const double length = times_[out.from + 1] - times_[out.from], f = (t - times_[out.from]) / length;
  if (between_ == FilmInterpolation::linear) {
    out.weight[2] = 1 / length;
    return out;
  }
  out.weight[2] = 6 * f * (1 - f) / length;
  add_tangent(out.from, (1 - f) * (1 - 3 * f), out);
  add_tangent(out.from + 1, f * (3 * f - 2), out);
  return out;
}

/// From the frame `from`.
Vec3d Film::difference(const Blend& of, Eigen::Index vertex) const {
  Vec3d out = Vec3d::Zero();
  for (std::size_t k = 0; k < of.weight.size(); ++k) {
    if (of.weight[k] == 0 || k == 1) continue;
    out += of.weight[k] * (frames_[of.from + k - 1].col(vertex) - frames_[of.from].col(vertex));
  }
  return out;
}

Vec3d Film::at(Eigen::Index vertex, double t) const {
  const Blend of = blend(t);
  return frames_[of.from].col(vertex) + difference(of, vertex);
}

void Film::at(double t, Eigen::Ref<Positions> out) const {
  const Blend of = blend(t);
  for (Eigen::Index v = 0; v < n_vertices(); ++v) {
    out.col(v) = frames_[of.from].col(v) + difference(of, v);
  }
}

Vec3d Film::velocity(Eigen::Index vertex, double t) const { return difference(rate(t), vertex); }

Film Film::moved(const Vec3d& by) const {
  Film out = *this;
  for (Positions& frame : out.frames_) frame.colwise() += by;
  return out;
}

}  // namespace bb
