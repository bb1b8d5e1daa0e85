// B of thick bodies of every kind along paths: its change is the integral of its gradient, and on both sides of every
// change of the closest feature gradient and Hessian are those of B.
#include <gtest/gtest.h>

#include "tests/contact/barrier_gradient.hpp"
#include "tests/contact/close_bodies.hpp"

namespace bb::test::close_energy_test {
namespace {

/// A path from x0 along which nothing touches.
struct Path {
  ContactSystem& contacts;
  Positions x0, dx;
  Positions state(double t) const { return x0 + t * dx; }
  double energy(double t) const { return barrier(contacts, state(t), 3.5, TestShape::cubic); }
  double slope(double t) const {
    return gradient_of(contacts, state(t)).dot(VecXd::Map(dx.data(), dx.size()));
  }
};

Path path_of(ContactSystem& contacts, const CloseBodies& bodies, double way, double stray, unsigned seed) {
  Positions x1 = approach(bodies, way, stray, seed);
  for (const Pin& pin : bodies.scene.pins) x1.col(pin.vertex) = bodies.scene.x0.col(pin.vertex);
  contacts.update_candidates(bodies.scene.x0, x1);
  const double alpha = contacts.step_bound(bodies.scene.x0, x1).alpha;
  return {contacts, bodies.scene.x0, 0.95 * alpha * (x1 - bodies.scene.x0)};
}

/// Gauss's rule with five points on each of n pieces.
double integral(const Path& path, int n) {
  constexpr double node[] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                             0.9061798459386640};
  constexpr double weight[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                               0.2369268850561891};
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < 5; ++i) sum += weight[i] / (2 * n) * path.slope((k + (1 + node[i]) / 2) / n);
  }
  return sum;
}

TEST(CloseEnergy, ChangesByTheIntegralOfItsGradient) {
  int compared = 0, large = 0;
  unsigned seed = 50;
  for_each_close_scene(3, 4000, [&](CloseBodies bodies) {
    if (bodies.pairs.empty()) return;
    for (double& d : bodies.scene.d_hat) d *= 20;
    ContactSystem contacts(bodies.scene, {});
    ++seed;
    const Path path = path_of(contacts, bodies, seed % 2 ? 0 : -0.1, 0.2, seed);
    const double from = path.energy(0), to = path.energy(1), size = std::max(from, to);
    if (!(size > 0)) return;
    // edges that are nearly parallel change their closest points fast
    double error = std::abs(integral(path, 40) - (to - from));
    if (error > 1e-4 * size) error = std::abs(integral(path, 1000) - (to - from));
    EXPECT_LT(error, 1e-4 * size) << seed;
    ++compared;
    large += std::abs(to - from) > 0.1 * size;
  });
  EXPECT_GT(compared, 150);
  EXPECT_GT(large, 80);
}

/// Gradient of B and its Hessian times dx by central differences about t.
void expect_derivatives(const Path& path, double t, double h) {
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(path.dx.size(), path.dx.size());
  const VecXd gradient = gradient_of(path.contacts, path.state(t), &hessian);
  const VecXd dx = VecXd::Map(path.dx.data(), path.dx.size());
  const double slope = (path.energy(t + h) - path.energy(t - h)) / (2 * h);
  EXPECT_NEAR(slope, gradient.dot(dx), 1e-5 * gradient.norm() * dx.norm() + 1e-16 / h);
  const VecXd bend =
      (gradient_of(path.contacts, path.state(t + h)) - gradient_of(path.contacts, path.state(t - h))) /
      (2 * h);
  const double size = hessian.norm() * dx.norm();
  EXPECT_LT((bend - hessian * dx).norm(), 1e-3 * size + 1e-13 / h);
  EXPECT_LT((hessian - hessian.transpose()).norm(), 1e-12 * hessian.norm());
}

using Features = std::vector<std::pair<ContactKey, ContactKind>>;
Features features(ContactSystem& contacts, const Positions& x) {
  Features out;
  const Rows rows = rows_at(contacts, x);
  for (std::size_t r = 0; r < rows.table.size(); ++r) out.push_back({rows.table.key(r), rows.table.kind[r]});
  for (std::size_t r = 0; r < rows.mollified.size(); ++r)
    out.push_back({rows.mollified.key(r), ContactKind::edge_edge});
  return out;
}

/// The first place of the path where a closest feature changes, to a few ulps of t; 0: none.
double first_change(const Path& path) {
  Features before = features(path.contacts, path.state(0));
  for (int k = 1; k <= 25; ++k) {
    if (features(path.contacts, path.state(k / 25.0)) == before) continue;
    double low = (k - 1) / 25.0, high = k / 25.0;
    for (int b = 0; b < 40; ++b) {
      const double middle = (low + high) / 2;
      (features(path.contacts, path.state(middle)) == before ? low : high) = middle;
    }
    return (low + high) / 2;
  }
  return 0;
}

TEST(CloseEnergy, HasItsDerivativesOnBothSidesOfEveryChangeOfTheClosestFeature) {
  int changes = 0, rows = 0;
  unsigned seed = 7;
  for_each_close_scene(12, 6000, [&](CloseBodies bodies) {
    if (bodies.pairs.empty()) return;
    for (double& d : bodies.scene.d_hat) d *= 20;
    ContactSystem contacts(bodies.scene, {});
    const Path path = path_of(contacts, bodies, -0.02, 0.1, ++seed);
    const double there = first_change(path);
    if (!(there > 1e-3 && there < 1 - 1e-3)) return;
    ++changes;
    rows += rows_at(contacts, path.state(there)).table.size() > 0;
    const VecXd left = gradient_of(contacts, path.state(there - 1e-9)),
                right = gradient_of(contacts, path.state(there + 1e-9));
    EXPECT_LT((left - right).norm(), 1e-5 * std::max(left.norm(), right.norm()) + 1e-12) << seed;
    for (const double side : {-1.0, 1.0}) {
      const double t = there + 2e-4 * side;
      const Features here = features(contacts, path.state(t));
      if (features(contacts, path.state(t - 1e-4)) != here ||
          features(contacts, path.state(t + 1e-4)) != here)
        continue;
      expect_derivatives(path, t, 2e-6);
    }
  });
  EXPECT_GT(changes, 80);
  EXPECT_GT(rows, 60);
}

}  // namespace
}  // namespace bb::test::close_energy_test
