#include "experiments/ccd/random_queries.hpp"

#include <random>

namespace bb::ccd {
namespace {

using Points = Eigen::Matrix<std::int64_t, 3, 4>;
using Point = Eigen::Matrix<std::int64_t, 3, 1>;
constexpr double unit = 0x1p-10;  // m

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : random_(seed) {}

  Query hit(PairKind kind, int family) {
    const int split = pair_split(kind);
    Points x = Points::Zero();
    for (int i = 0; i < 4; ++i) x.col(i) = 16 * point(100);
    if (family == 2) x.col(3) = x.col(2);  // no area, or no length
    if (family == 3 && kind == PairKind::point_triangle) x.row(2).setConstant(x(2, 1));
    if (family == 3 && kind == PairKind::edge_edge) x.col(3) = x.col(2) + (x.col(1) - x.col(0));
    const Point a = inside(x, 0, split, family == 1), b = inside(x, split, 4, family == 1);
    for (int i = 0; i < split; ++i) x.col(i) += b - a;  // now both points are one
    Points v;
    for (int i = 0; i < 4; ++i) v.col(i) = point(family == 3 ? 40 : 200);
    if (family == 3 && kind == PairKind::point_triangle) v.row(2).setZero();
    if (family == 4) {
      const Point far = (std::int64_t{1} << 22) * Point(sign(), sign(), sign());
      x.colwise() += far;
    }
    const std::int64_t steps = family == 5 ? 16 * below(2) : below(17);
    return query(x - steps * v, x + (16 - steps) * v, true);
  }

  Query apart(PairKind kind, int family) {
    const int split = pair_split(kind);
    const std::int64_t gap = std::int64_t{1} << (family * 2);  // 1 to 1024 units
    Points x0, x1;
    for (Points* x : {&x0, &x1}) {
      for (int i = 0; i < 4; ++i) {
        x->col(i) = point(2000);
        std::int64_t& height = (*x)(2, i);
        height = i < split ? gap + std::abs(height) : -std::abs(height);
        if (below(2) == 0) height = i < split ? gap : 0;  // close to the plane
      }
    }
    shear(x0, x1);
    const Point drift = point(3000);
    x1.colwise() += drift;
    return query(x0, x1, false);
  }

 private:
  std::int64_t below(std::int64_t n) {
    return std::uniform_int_distribution<std::int64_t>(0, n - 1)(random_);
  }
  std::int64_t sign() { return 2 * below(2) - 1; }
  Point point(std::int64_t most) {
    return Point::NullaryExpr([&] { return below(2 * most + 1) - most; });
  }

  /// A convex combination in sixteenths of the points first to last; on the rim: of fewer than all where it can.
  Point inside(const Points& x, int first, int last, bool on_rim) {
    std::int64_t left = 16;
    Point sum = Point::Zero();
    const int skipped = on_rim && last - first > 1 ? first + static_cast<int>(below(last - first)) : -1;
    int final_point = last - 1 == skipped ? last - 2 : last - 1;
    for (int i = first; i < last; ++i) {
      if (i == skipped) continue;
      const std::int64_t weight = i == final_point ? left : below(left + 1);
      left -= weight;
      sum += weight * (x.col(i) / 16);
    }
    return sum;
  }

  /// Three integer shears and an exchange of axes, the same at both ends: planes stay planes.
  void shear(Points& x0, Points& x1) {
    for (int k = 0; k < 3; ++k) {
      const auto to = below(3), from = (to + 1 + below(2)) % 3;
      const std::int64_t times = below(5) - 2;
      for (Points* x : {&x0, &x1}) x->row(to) += times * x->row(from);
    }
  }

  static Query query(const Points& x0, const Points& x1, bool hits) {
    Query out;
    out.x0 = x0.cast<double>() * unit;
    out.x1 = x1.cast<double>() * unit;
    out.hits = hits;
    return out;
  }

  std::mt19937_64 random_;
};

}  // namespace

QuerySet random_queries(int n, std::uint64_t seed) {
  constexpr int n_families = 6;
  Generator generator(seed);
  QuerySet out;
  for (int k = 0; k < n; ++k) {
    const int family = (k / 2) % n_families;
    for (const PairKind kind : {PairKind::point_triangle, PairKind::edge_edge}) {
      auto& queries = kind == PairKind::point_triangle ? out.point_triangle : out.edge_edge;
      queries.push_back(k % 2 == 0 ? generator.hit(kind, family) : generator.apart(kind, family));
    }
  }
  return out;
}

}  // namespace bb::ccd
