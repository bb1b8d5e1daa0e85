// Pairs of a scene and their gaps by brute force, with thickness: nothing here uses the geometry under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

using Corners = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 4>;

/// Closest points of two simplices of one to three corners.
struct TrueClosest {
  double d = std::numeric_limits<double>::infinity();
  Vec3d from = Vec3d::Zero(), to = Vec3d::Zero();
};

/// Weights that bring two affine hulls closest, by normal equations in long double; false where they are (nearly)
/// parallel: then a pair of smaller faces is as close.
inline bool closest_of_hulls(const std::vector<Vec3d>& sides, const Vec3d& r, long double* out) {
  using L = long double;
  const auto dot = [](const Vec3d& a, const Vec3d& b) {
    return L(a[0]) * L(b[0]) + L(a[1]) * L(b[1]) + L(a[2]) * L(b[2]);
  };
  if (sides.empty()) return true;
  const L aa = dot(sides[0], sides[0]), ar = dot(sides[0], r);
  if (sides.size() == 1) {
    out[0] = aa > 0 ? -ar / aa : -1;
    return aa > 0;
  }
  const L bb = dot(sides[1], sides[1]), ab = dot(sides[0], sides[1]), br = dot(sides[1], r);
  const L det = aa * bb - ab * ab;
  if (!(det > 1e-17L * aa * bb)) return false;
  out[0] = (ab * br - bb * ar) / det;
  out[1] = (ab * ar - aa * br) / det;
  return true;
}

/// Of one pair of faces, given by the numbers of their corners; false where the closest points are outside of them.
inline bool closest_of_faces(const Corners& a, const Corners& b, const std::vector<int>& fa,
                             const std::vector<int>& fb, TrueClosest& best) {
  std::vector<Vec3d> sides;
  for (std::size_t k = 1; k < fa.size(); ++k) sides.push_back(a.col(fa[k]) - a.col(fa[0]));
  for (std::size_t k = 1; k < fb.size(); ++k) sides.push_back(b.col(fb[0]) - b.col(fb[k]));
  if (sides.size() > 2) return false;
  long double w[2] = {0, 0};
  if (!closest_of_hulls(sides, a.col(fa[0]) - b.col(fb[0]), w)) return false;
  long double sum_a = 0, sum_b = 0;
  Vec3d p = a.col(fa[0]), q = b.col(fb[0]);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    if (w[k] < 0) return false;
    const bool of_a = k + 1 < fa.size();
    (of_a ? sum_a : sum_b) += w[k];
    (of_a ? p : q) += static_cast<double>(of_a ? w[k] : -w[k]) * sides[k];
  }
  if (sum_a > 1 || sum_b > 1) return false;
  const double d = (p - q).norm();
  if (d < best.d) best = {d, p, q};
  return true;
}

/// Every pair of faces is queried. Two triangles are no pair here: they have three free weights too many.
inline TrueClosest true_closest(const Corners& a, const Corners& b) {
  static const std::vector<std::vector<int>> faces[] = {
      {}, {{0}}, {{0}, {1}, {0, 1}}, {{0}, {1}, {2}, {0, 1}, {1, 2}, {2, 0}, {0, 1, 2}}};
  TrueClosest best;
  for (const auto& fa : faces[a.cols()]) {
    for (const auto& fb : faces[b.cols()]) closest_of_faces(a, b, fa, fb, best);
  }
  return best;
}

/// A pair as docs/theory/contact-models.md has it (Contact rows): primitives by their vertices, or one and an obstacle.
struct TruePair {
  std::vector<int> first, second;
  int obstacle = -1;
  double d_hat = 0, offset = 0;  // m
};

/// Gap of a pair, thickness taken off, with the closest points; m.
inline double true_gap(const Scene& scene, const TruePair& pair, const Positions& x,
                       TrueClosest* where = nullptr) {
  const auto corners = [&x](const std::vector<int>& vertices) {
    Corners out(3, static_cast<Eigen::Index>(vertices.size()));
    for (std::size_t k = 0; k < vertices.size(); ++k) out.col(static_cast<int>(k)) = x.col(vertices[k]);
    return out;
  };
  Corners a = corners(pair.first);
  TrueClosest local;
  TrueClosest& closest = where ? *where : local;
  if (pair.obstacle < 0) {
    closest = true_closest(a, corners(pair.second));
    return closest.d - pair.offset;
  }
  const Obstacle& o = scene.obstacles[at(pair.obstacle)];
  Corners centre(3, 1);
  centre.col(0).setZero();
  for (Eigen::Index k = 0; k < a.cols(); ++k) {
    a.col(k) -= o.point;
    if (o.kind == ObstacleKind::cylinder) a.col(k) -= o.axis * o.axis.dot(a.col(k));
  }
  if (o.kind == ObstacleKind::plane) {
    closest = {o.axis.dot(a.col(0)), o.axis, Vec3d::Zero()};
    return closest.d - pair.offset;
  }
  closest = true_closest(a, centre);
  return (o.inside ? o.radius - closest.d : closest.d - o.radius) - pair.offset;
}

/// All pairs of a scene with a free vertex.
class TruePairs {
 public:
  explicit TruePairs(const Scene& scene) : scene_(scene), free_(at(scene.n_vertices()), 1) {
    for (const Pin& pin : scene.pins) free_[at(pin.vertex)] = 0;
    for (const int v : scene.surface_vertices) points_.push_back({v});
    for (const auto& t : scene.surface_triangles) triangles_.push_back({t[0], t[1], t[2]});
    for (const auto& t : scene.surface_triangles) {
      for (std::size_t k = 0; k < 3; ++k) add_edge(sides_, t[k], t[(k + 1) % 3]);
    }
    for (const auto& e : scene.surface_edges) {
      if (std::find(sides_.begin(), sides_.end(), sorted(e[0], e[1])) == sides_.end())
        add_edge(lone_, e[0], e[1]);
    }
    edges_ = sides_;
    edges_.insert(edges_.end(), lone_.begin(), lone_.end());
    add_pairs();
    for (std::size_t o = 0; o < scene.obstacles.size(); ++o) add_obstacle(static_cast<int>(o));
  }
  std::vector<TruePair> pairs;

 private:
  using List = std::vector<std::vector<int>>;
  static std::vector<int> sorted(int a, int b) {
    return a < b ? std::vector<int>{a, b} : std::vector<int>{b, a};
  }
  static void add_edge(List& list, int a, int b) {
    if (std::find(list.begin(), list.end(), sorted(a, b)) == list.end()) list.push_back(sorted(a, b));
  }
  bool covered(int v, const List& by) const {
    return std::any_of(by.begin(), by.end(),
                       [v](const auto& p) { return std::find(p.begin(), p.end(), v) != p.end(); });
  }
  double mean(const std::vector<double>& column, const std::vector<int>& vertices) const {
    double sum = 0;
    for (const int v : vertices) sum += column[at(v)];
    return sum / static_cast<double>(vertices.size());
  }
  bool any_free(const std::vector<int>& vertices) const {
    return std::any_of(vertices.begin(), vertices.end(), [this](int v) { return free_[at(v)] != 0; });
  }
  void add(const std::vector<int>& a, const std::vector<int>& b) {
    for (const int v : a) {
      if (std::find(b.begin(), b.end(), v) != b.end()) return;
    }
    if (!any_free(a) && !any_free(b)) return;
    const double d_hat = (mean(scene_.d_hat, a) + mean(scene_.d_hat, b)) / 2;
    pairs.push_back({a, b, -1, d_hat, mean(scene_.offset, a) + mean(scene_.offset, b)});
  }
  void cross(const List& a, const List& b) {
    for (const auto& p : a) {
      for (const auto& q : b) add(p, q);
    }
  }
  bool opposite(int v, const std::vector<int>& edge) const {
    for (const auto& t : scene_.membrane_triangles()) {
      if (std::count(t.begin(), t.end(), v) && std::count(t.begin(), t.end(), edge[0]) &&
          std::count(t.begin(), t.end(), edge[1]))
        return true;
    }
    return false;
  }
  void add_pairs() {
    if (scene_.planar) {
      for (const auto& p : points_) {
        for (const auto& e : edges_) {
          if (!opposite(p[0], e)) add(p, e);
        }
      }
      return;
    }
    cross(points_, triangles_);
    cross(points_, lone_);
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      for (std::size_t j = i + 1; j < edges_.size(); ++j) add(edges_[i], edges_[j]);
    }
  }
  void add_obstacle(int index) {
    const Obstacle& o = scene_.obstacles[at(index)];
    const auto take = [&](const std::vector<int>& a) {
      if (any_free(a)) pairs.push_back({a, {}, index, mean(scene_.d_hat, a), mean(scene_.offset, a)});
    };
    const bool convex = o.inside || o.kind == ObstacleKind::plane;
    const bool bar = o.kind == ObstacleKind::cylinder && !scene_.planar;
    for (const auto& p : points_) {
      if (convex || bar || !covered(p[0], edges_)) take(p);
    }
    if (convex) return;
    for (const auto& e : bar ? edges_ : lone_) take(e);
    for (const auto& t : triangles_) {
      if (!bar) take(t);
    }
  }

  const Scene& scene_;
  std::vector<std::uint8_t> free_;
  List points_, edges_, sides_, lone_, triangles_;
};

/// The smallest gap of all pairs, m; *which: where it is.
inline double least_true_gap(const Scene& scene, const std::vector<TruePair>& pairs, const Positions& x,
                             std::size_t* which = nullptr) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const double gap = true_gap(scene, pairs[p], x);
    if (gap < least) {
      least = gap;
      if (which) *which = p;
    }
  }
  return least;
}

}  // namespace bb::test
