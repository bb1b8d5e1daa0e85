// A pair of primitives in straight motion, seen as one moving convex polygon: the differences of their
// vertices. The primitives meet at a time exactly when the polygon contains the origin. Separation by
// a fixed direction.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/math/types.hpp"

namespace bb::audit {

/// Vertex 0 against triangle 1 2 3: the triangle of differences.
struct VertexTriangle {
  static constexpr int dim = 3, n_points = 4, n_corners = 3;
  static constexpr int corner[n_corners][2] = {{0, 1}, {0, 2}, {0, 3}};
};

/// Edge 0 1 against edge 2 3: a parallelogram, corners in cyclic order.
struct EdgeEdge {
  static constexpr int dim = 3, n_points = 4, n_corners = 4;
  static constexpr int corner[n_corners][2] = {{0, 2}, {1, 2}, {1, 3}, {0, 3}};
};

/// Vertex 0 against edge 1 2 in the plane: a segment.
struct VertexEdge2d {
  static constexpr int dim = 2, n_points = 3, n_corners = 2;
  static constexpr int corner[n_corners][2] = {{0, 1}, {0, 2}};
};

/// Positions of the pair's points at the two ends of the motion (m).
template <class Pair>
struct PairMotion {
  using Point = Vec<double, Pair::dim>;
  std::array<Point, Pair::n_points> x0, x1;
};

/// Times are integers over 2^50, so that t and 1 - t are exact doubles.
struct TimeSpan {
  static constexpr std::int64_t one = std::int64_t{1} << 50;
  std::int64_t begin = 0, end = one;
  static double fraction(std::int64_t t) { return static_cast<double>(t) * 0x1p-50; }
  std::int64_t middle() const { return begin + (end - begin) / 2; }
  double length() const { return fraction(end - begin); }
};

/// The moving polygon in floating point.
template <class Pair>
class MovingPolygon {
 public:
  static constexpr int dim = Pair::dim, n_corners = Pair::n_corners;
  using Point = Vec<double, dim>;

  explicit MovingPolygon(const PairMotion<Pair>& m) {
    for (int k = 0; k < n_corners; ++k) {
      const auto i = static_cast<std::size_t>(Pair::corner[k][0]),
                 j = static_cast<std::size_t>(Pair::corner[k][1]);
      begin_[k] = m.x0[i] - m.x0[j];
      end_[k] = m.x1[i] - m.x1[j];
      bound_ = bound_.cwiseMax(begin_[k].cwiseAbs()).cwiseMax(end_[k].cwiseAbs());
    }
  }

  /// True only if `direction` proves that the origin is outside the polygon during the whole span: every
  /// corner's height n.D(t) is affine in t, so both ends of the span decide. Each height passes one
  /// difference, one product, at most dim - 1 sums, one product with t or 1 - t and one sum, each 2^-53
  /// relative to |n|.bound: at most 8 x 2^-53. Underflow adds less than 2^-1000. Not-a-number and
  /// overflow compare false.
  bool separates(const Point& direction, const TimeSpan& span) const {
    const double allowance = 0x1p-50 * direction.cwiseAbs().dot(bound_) + 0x1p-1000;
    const double tb = TimeSpan::fraction(span.begin), te = TimeSpan::fraction(span.end);
    bool above = true, below = true;
    for (int k = 0; k < n_corners; ++k) {
      const double h0 = direction.dot(begin_[k]), h1 = direction.dot(end_[k]);
      const double at_begin = (1.0 - tb) * h0 + tb * h1, at_end = (1.0 - te) * h0 + te * h1;
      above = above && at_begin > allowance && at_end > allowance;
      below = below && at_begin < -allowance && at_end < -allowance;
      if (!above && !below) return false;
    }
    return true;
  }

  /// Coordinate axes: the cheap first filter.
  bool axis_separates(const TimeSpan& span) const {
    for (int k = 0; k < dim; ++k) {
      if (separates(Point::Unit(k), span)) return true;
    }
    return false;
  }

  /// Offers directions to `accept` until it returns true: the polygon's normal, the directions from the
  /// origin to its corners and perpendicular to its sides, all at time t. The closest point's direction
  /// is among them.
  template <class F>
  bool any_direction(std::int64_t t, F&& accept) const {
    Point d[n_corners];
    for (int k = 0; k < n_corners; ++k) d[k] = corner(k, t);
    if (accept(normal(t))) return true;
    for (int k = 0; k < n_corners; ++k) {
      if (accept(d[k])) return true;
    }
    for (int k = 0; dim == 3 && k < n_corners; ++k) {
      const Point side = d[(k + 1) % n_corners] - d[k];
      const double length_sq = side.squaredNorm();
      if (length_sq > 0.0 && accept(Point(d[k] - side * (d[k].dot(side) / length_sq)))) return true;
    }
    return false;
  }

  bool any_separates(const TimeSpan& span) const {
    return any_direction(span.middle(), [&](const Point& n) { return separates(n, span); });
  }

  /// ExactPolygon::proves_passage in plain floating point: a hint that the exact proof is worth its price.
  bool seems_to_pass(const Point& direction, const TimeSpan& span) const {
    Point a[n_corners], b[n_corners];
    for (int k = 0; k < n_corners; ++k) a[k] = corner(k, span.begin), b[k] = corner(k, span.end);
    if constexpr (dim == 2) {
      const auto wedge = [](const Point& u, const Point& v) { return u[0] * v[1] - u[1] * v[0]; };
      return wedge(a[0], a[1]) * wedge(b[0], b[1]) <= 0.0 &&
             wedge(direction, a[0]) * wedge(direction, a[1]) <= 0.0;
    } else {
      if (a[0].dot(a[1].cross(a[2])) * b[0].dot(b[1].cross(b[2])) > 0.0) return false;
      bool left = true, right = true;
      for (int k = 0; k < n_corners; ++k) {
        const int next = (k + 1) % n_corners;
        const double at_begin = direction.dot(a[k].cross(a[next])),
                     at_end = direction.dot(b[k].cross(b[next]));
        left = left && at_begin >= 0.0 && at_end >= 0.0;
        right = right && at_begin <= 0.0 && at_end <= 0.0;
      }
      return left || right;
    }
  }

  /// Not normalised; of the plane (3D) or line (2D) through the polygon at time t, rounded.
  Point normal(std::int64_t t) const {
    const Point side = corner(1, t) - corner(0, t);
    if constexpr (dim == 3) {
      return side.cross(corner(2, t) - corner(1, t));
    } else {
      return Point(-side[1], side[0]);
    }
  }

  /// Largest motion of a corner over [0, 1] in any coordinate, and the largest coordinate (m).
  double motion() const {
    double most = 0.0;
    for (int k = 0; k < n_corners; ++k) most = std::max(most, (end_[k] - begin_[k]).cwiseAbs().maxCoeff());
    return most;
  }
  double size() const { return bound_.maxCoeff(); }

 private:
  Point corner(int k, std::int64_t t) const {
    const double s = TimeSpan::fraction(t);
    return (1.0 - s) * begin_[k] + s * end_[k];
  }

  Point begin_[n_corners], end_[n_corners];
  Point bound_ = Point::Zero();
};

}  // namespace bb::audit
