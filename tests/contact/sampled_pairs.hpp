// A pair of two primitives at random, and motions of either towards the other.
#pragma once

#include <algorithm>
#include <random>

#include "tests/contact/bound_of.hpp"
#include "tests/geometry/closest_oracle.hpp"

namespace bb::test {

inline constexpr double gamma = 0.9;

/// Least distance between the two primitives of a pair, the first `split` columns and the rest.
inline double distance_of(const Positions& x, int split) {
  Points<Long, 4> points = x.leftCols<4>().cast<Long>();
  return static_cast<double>(enumerate_faces(points, 4, split).d);
}

/// Two bodies that are one primitive each: their vertices and the scene.
struct PairScene {
  Scene scene;
  int n = 0, split = 0;
  double distance(const Positions& x) const { return distance_of(x, split); }
};

struct Random {
  std::mt19937_64 rng;
  explicit Random(unsigned seed) : rng(seed) {}
  double unit() { return std::uniform_real_distribution<double>(-1, 1)(rng); }
  double between(double a, double b) { return a + (b - a) * (unit() + 1) / 2; }
  Vec3d direction() {
    Vec3d out(unit(), unit(), unit());
    while (out.squaredNorm() > 1 || out.squaredNorm() < 0.01) out = Vec3d(unit(), unit(), unit());
    return out.normalized();
  }
  /// A way towards the other side in gaps: nothing, just below and above half of it, all of it, several.
  double share() {
    constexpr double shares[] = {0, 0.3, 0.46, 0.54, 0.7, 0.9, 0.98, 1.05, 3, -0.5};
    return shares[rng() % std::size(shares)] * between(0.98, 1.02);
  }
};

/// A point and a triangle, or two edges, `gap` and the thickness of both apart along z, turned anyhow.
inline PairScene pair_scene(Random& random, double gap, double offset) {
  PairScene out;
  const int kind = static_cast<int>(random.rng() % 2);
  const double size = random.between(0.3, 1), far = gap + 2 * offset;
  std::vector<Vec3d> first, second;
  if (kind == 0) {
    first = {Vec3d(0, 0, far)};
    second = {size * Vec3d(-1, -0.7, 0), size * Vec3d(1, -0.6, 0), size * Vec3d(random.unit(), 1, 0)};
  } else {
    first = {Vec3d(-size, 0.2 * random.unit(), far), Vec3d(size, 0.2 * random.unit(), far)};
    second = {Vec3d(0.2 * random.unit(), -size, 0), Vec3d(0.2 * random.unit(), size, 0)};
  }
  for (Vec3d& x : second) x[2] -= random.rng() % 2 == 0 ? 0 : gap * random.between(0, 1) * (x[0] > 0);
  const Eigen::AngleAxisd turn(random.between(0, 6), random.direction());
  for (auto* side : {&first, &second})
    for (Vec3d& x : *side) x = turn * x;
  const auto add = [&](const std::string& name, const std::vector<Vec3d>& x) {
    const Triangles triangles = x.size() == 3 ? Triangles{{0, 1, 2}} : Triangles{};
    const int at = add_body(out.scene, name, x, triangles, d_hat, false, offset);
    if (x.size() == 2) out.scene.surface_edges.push_back({at, at + 1});
  };
  add("first", first);
  add("second", second);
  if (kind == 0) out.scene.surface_edges = {{1, 2}, {2, 3}, {1, 3}};
  out.n = static_cast<int>(first.size() + second.size());
  out.split = static_cast<int>(first.size());
  return out;
}

/// Each side goes towards the other.
inline Positions head_on(Random& random, const PairScene& pair, double gap) {
  const Positions& x = pair.scene.x0;
  Vec3d towards = x.rightCols(pair.n - pair.split).rowwise().mean() - x.leftCols(pair.split).rowwise().mean();
  Positions x1 = x;
  const double first = random.share(), second = random.share();
  const bool even = random.rng() % 2 == 0;
  // along the shortest way, which the planes of the construction are across
  Points<Long, 4> padded = Points<Long, 4>::Zero();
  padded.leftCols(pair.n) = x.cast<Long>();
  const Vec3d r = enumerate_faces(padded, pair.n, pair.split).r.cast<double>();
  if (r.norm() > 0) towards = r.dot(towards) < 0 ? Vec3d(-r) : r;
  const Vec3d n = towards.normalized();
  for (int v = 0; v < pair.n; ++v) {
    const double way = (even ? 1 : random.between(0.2, 1)) * gap * (v < pair.split ? first : second);
    x1.col(v) += (v < pair.split ? way : -way) * n + 0.02 * gap * random.unit() * random.direction();
  }
  return x1;
}

/// What the bounds let each vertex go of its way to x1.
inline std::vector<double> parts_of(const Scene& scene, const Positions& x1, StepBoundRule rule) {
  ContactOptions options;
  options.step_bound = rule;
  ContactSystem contacts(scene, options);
  contacts.update_candidates_of_each(scene.x0, x1);
  contacts.vertex_bounds(scene.x0, x1);
  return {contacts.vertex_parts().begin(), contacts.vertex_parts().end()};
}

}  // namespace bb::test
