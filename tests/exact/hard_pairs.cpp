#include "tests/exact/hard_pairs.hpp"

#include <cmath>
#include <numbers>

namespace bb::test {
namespace {

using Points = Mat<double, 3, 4>;

class Maker {
 public:
  Maker(PairKind kind, bool in_float, std::mt19937_64& random)
      : kind_(kind), in_float_(in_float), random_(random) {}

  Points make(Family family) {
    Points x = uniform_points();
    switch (family) {
      case Family::random:
        break;
      case Family::needle:
        thin(x, power(-15, -1));
        if (coin()) above_inside(x, power(-15, 0));
        break;
      case Family::no_area:
        thin(x, 0);
        break;
      case Family::parallel:
        parallel(x);
        break;
      case Family::coplanar:
        x.row(2).setConstant(coin() ? 0 : 0.375);
        break;
      case Family::coincident:
        x.col(index()) = x.col(index());
        break;
      case Family::offset:
        x.colwise() += Vec3d(power(1, in_float_ ? 3 : 6) * uniform_points().col(0));
        break;
      case Family::mixed:
        for (int i = 0; i < 4; ++i) x.col(i) *= power(-6, 0);
        break;
      case Family::obtuse:
        obtuse(x);
        break;
      case Family::small_gap:
        above_inside(x, power(-15, -2));
        break;
      case Family::large:
        x *= in_float_ ? 1e4 : 1e8;
        break;
      case Family::tiny:
        x *= in_float_ ? 1e-7 : 1e-60;
        break;
      case Family::denormal:
        x *= in_float_ ? power(-44, -30) : power(-322, -250);
        break;
    }
    return x;
  }

 private:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double power(double low, double high) { return std::pow(10, uniform(low, high)); }
  bool coin() { return uniform(0, 1) < 0.5; }
  int index() { return std::uniform_int_distribution<int>(0, pair_points(kind_) - 1)(random_); }
  Points uniform_points() {
    return Points::NullaryExpr([&] { return uniform(-1, 1); });
  }

  /// The last point comes near to the line of the two before it, or to the point before it on an edge.
  void thin(Points& x, double how) {
    const Vec3d aside = how * x.col(3);
    if (kind_ == PairKind::point_triangle) {
      // a multiple of the edge by a power of two, so that without `aside` it is exactly collinear
      x.col(1) = x.col(2) + 2 * (x.col(1) - x.col(2)) * (coin() ? 0.25 : -1.0);
      x.col(3) = 0.5 * (x.col(1) + x.col(2)) + aside;
      if (how == 0 && coin()) x.col(3) = x.col(2);
    } else {
      const int last = pair_points(kind_) - 1;
      x.col(last) = x.col(last - 1) + how * x.col(last);
      if (how == 0 && coin() && kind_ == PairKind::edge_edge) x.col(1) = x.col(0);
    }
  }

  void parallel(Points& x) {
    if (kind_ != PairKind::edge_edge) return above_inside(x, uniform(0, 0.1));
    const double angle = coin() ? power(-7, -1) : 0;
    const Vec3d u = x.col(1) - x.col(0), aside = uniform_points().col(0);
    x.col(2) = x.col(0) + uniform(-1, 1) * u + power(-6, 0) * aside;
    x.col(3) = x.col(2) + uniform(0.2, 1.5) * u + angle * Vec3d(uniform_points().col(0));
    if (angle > 0 && coin()) above_inside(x, power(-15, -1));  // they cross, seen along their common normal
  }

  /// Apex at one of the corners; the point anywhere, often just above the plane.
  void obtuse(Points& x) {
    const double angle = (coin() ? uniform(60, 179.99) : 180 - power(-2, 0)) * std::numbers::pi / 180;
    const double height = coin() ? uniform(0, 0.25) : power(-6, -1);
    const int apex = std::uniform_int_distribution<int>(0, 2)(random_);
    x.col(0) = Vec3d(uniform(-1.5, 1.5), uniform(-0.5, 1.5), height);
    x.col(1 + apex) = Vec3d::Zero();
    x.col(1 + (apex + 1) % 3) = Vec3d(1, 0, 0);
    x.col(1 + (apex + 2) % 3) = Vec3d(std::cos(angle), std::sin(angle), 0);
  }

  /// The first primitive gets `gap` away from an inner point of the second.
  void above_inside(Points& x, double gap) {
    const double s = uniform(0.05, 0.6), t = uniform(0.05, 0.35);
    if (kind_ == PairKind::point_triangle) {
      const Vec3d n = (x.col(2) - x.col(1)).cross(x.col(3) - x.col(1)).normalized();
      x.col(0) = (1 - s - t) * x.col(1) + s * x.col(2) + t * x.col(3) + gap * n;
    } else if (kind_ == PairKind::edge_edge) {
      const Vec3d n = (x.col(1) - x.col(0)).cross(x.col(3) - x.col(2)).normalized();
      const Vec3d shift = (1 - t) * x.col(2) + t * x.col(3) + gap * n - ((1 - s) * x.col(0) + s * x.col(1));
      x.col(0) += shift;
      x.col(1) += shift;
    } else if (kind_ == PairKind::point_edge) {
      x.col(0) = (1 - s) * x.col(1) + s * x.col(2) + gap * Vec3d(uniform_points().col(0));
    } else {
      x.col(0) = x.col(1) + gap * Vec3d(uniform_points().col(0));
    }
  }

  PairKind kind_;
  bool in_float_;
  std::mt19937_64& random_;
};

}  // namespace

const char* family_name(Family family) {
  constexpr const char* names[n_families] = {"random",     "needle", "no_area", "parallel", "coplanar",
                                             "coincident", "offset", "mixed",   "obtuse",   "small_gap",
                                             "large",      "tiny",   "denormal"};
  return names[static_cast<int>(family)];
}

Mat<double, 3, 4> hard_pair(Family family, PairKind kind, bool in_float, std::mt19937_64& random) {
  const Points x = Maker(kind, in_float, random).make(family);
  const Mat<float, 3, 4> rounded =
      x.cast<float>();  // in its own variable: Eigen drops a cast to float and back
  return in_float ? Points(rounded.cast<double>()) : x;
}

}  // namespace bb::test
