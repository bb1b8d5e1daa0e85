// Step bound and exact signs on pairs made so that the answer is known.
#include <random>

#include "core/audit/predicates.hpp"
#include "core/geometry/accd.hpp"
#include "experiments/validity/block.hpp"

namespace bb {
namespace {

constexpr int n_pairs = 2000;

Vec3d random_point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  return {unit(random), unit(random), unit(random)};
}

/// A vertex that moves from above an inner point of a triangle to below it, everything turned at random: they touch
/// at half time.
Mat<double, 3, 4> crossing_pair(std::mt19937_64& random, double height, Mat<double, 3, 4>& end) {
  std::uniform_real_distribution<double> inside(0.1, 0.4);
  const Vec3d a = random_point(random), b = random_point(random), c = random_point(random);
  const double u = inside(random), v = inside(random);
  const Vec3d n = (b - a).cross(c - a).normalized(), p = a + u * (b - a) + v * (c - a);
  Mat<double, 3, 4> start;
  start << p + height * n, a, b, c;
  end << p - height * n, a, b, c;
  const Vec3d drift = random_point(random);
  end.colwise() += drift;
  return start;
}

/// The same of two edges that cross at inner points.
Mat<double, 3, 4> crossing_edges(std::mt19937_64& random, double height, Mat<double, 3, 4>& end) {
  const Vec3d p = random_point(random), u = random_point(random), v = random_point(random);
  const Vec3d n = u.cross(v).normalized(), up = height * n;
  Mat<double, 3, 4> start;
  start << p + up - u, p + up + u, p - 0.7 * v, p + 0.9 * v;
  end << p - up - u, p - up + u, p - 0.7 * v, p + 0.9 * v;
  return start;
}

template <PairKind K>
void judge_crossing(BlockCheck& check, const Mat<double, 3, 4>& start, const Mat<double, 3, 4>& end) {
  const AccdResult<double> result = accd<K, double>(start, end, 0.0, 1e-9);
  check.judge(result.toi < 0.5 && result.hit ? 0 : 1, pair_name(K));
}

}  // namespace

void check_ccd(BlockCheck& check) {
  std::mt19937_64 random(7);
  for (int i = 0; i < n_pairs; ++i) {
    const double height = std::pow(10.0, -(i % 7));
    Mat<double, 3, 4> end;
    const Mat<double, 3, 4> triangle = crossing_pair(random, height, end);
    judge_crossing<PairKind::point_triangle>(check, triangle, end);
    const Mat<double, 3, 4> edges = crossing_edges(random, height, end);
    judge_crossing<PairKind::edge_edge>(check, edges, end);
  }
}

void check_predicates(BlockCheck& check) {
  std::mt19937_64 random(7);
  check.judge(audit::predicates_self_test() ? 0 : 1, "self-test");
  for (int i = 0; i < n_pairs; ++i) {
    const Vec3d a = random_point(random), b = random_point(random), c = random_point(random);
    const Vec3d d = a + 0.3 * (b - a) + 0.4 * (c - a);  // in the plane but for rounding
    check.judge(audit::orient3d(a, b, c, d) == audit::orient3d_exact(a, b, c, d) ? 0 : 1, "orient3d");
    const Vec2d p = a.head<2>(), q = b.head<2>(), r = p + 0.3 * (q - p);
    check.judge(audit::orient2d(p, q, r) == audit::orient2d_exact(p, q, r) ? 0 : 1, "orient2d");
  }
}

}  // namespace bb
