// Local gradients and Hessians of the rows against finite differences of the energy, kappa fixed.
#include <gtest/gtest.h>

#include "core/math/lower_blocks.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/oracle/dense.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::contact_terms_test {
namespace {

constexpr double kappa = 3.5;
using Matrix = Eigen::MatrixXd;

struct Assembled {
  VecXd gradient;  // [3 n_vertices], prescribed vertices included: they must stay 0
  Matrix hessian;
  std::size_t n_rows;
};

void scatter(const std::vector<int>& vertex, std::size_t n_rows, const std::vector<double>& grad,
             const std::vector<double>& hess, Assembled& out) {
  for (std::size_t r = 0; r < n_rows; ++r) {
    const Matrix h = from_lower_blocks(&hess[n_lower_numbers(4) * r], 4);
    for (int i = 0; i < 4; ++i) {
      const int vi = vertex[4 * r + at(i)];
      if (vi < 0) {
        EXPECT_TRUE((h.middleRows<3>(3 * i).isZero(0)));
        EXPECT_TRUE((h.middleCols<3>(3 * i).isZero(0)));
        EXPECT_TRUE((Vec3d::Map(&grad[12 * r + 3 * at(i)]).isZero(0)));
        continue;
      }
      out.gradient.segment<3>(3 * vi) += Vec3d::Map(&grad[12 * r + 3 * at(i)]);
      for (int j = 0; j < 4; ++j) {
        const int vj = vertex[4 * r + at(j)];
        if (vj >= 0) out.hessian.block<3, 3>(3 * vi, 3 * vj) += h.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
}

Assembled assemble(ContactSystem& contacts, const Positions& x, HessianMode mode) {
  Rows rows = rows_at(contacts, x);
  evaluate(rows.table, kappa, TestShape::cubic);
  evaluate(rows.mollified, kappa, TestShape::cubic);
  Assembled out{VecXd::Zero(x.size()), Matrix::Zero(x.size(), x.size()),
                rows.table.size() + rows.mollified.size()};
  std::vector<double> grad(1, 7.0), hess(1, 7.0);
  contact_terms(rows.table, x, mode, Projection::psd, grad, hess);
  scatter(rows.table.vertex, rows.table.size(), grad, hess, out);
  mollified_terms(rows.mollified, x, Projection::psd, grad, hess);
  scatter(rows.mollified.free_vertex, rows.mollified.size(), grad, hess, out);
  return out;
}

/// Central differences of B in the free coordinates, best over a ladder of steps.
double gradient_error(ContactSystem& contacts, const Scene& scene, const VecXd& gradient) {
  std::vector<bool> given(at(scene.n_vertices()), false);
  for (const Pin& p : scene.pins) given[at(p.vertex)] = true;
  double best = std::numeric_limits<double>::infinity();
  for (double h : {1e-4, 1e-5, 1e-6}) {
    VecXd numeric = VecXd::Zero(gradient.size());
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      if (given[static_cast<std::size_t>(k / 3)]) continue;
      Positions up = scene.x0, down = scene.x0;
      up.data()[k] += h;
      down.data()[k] -= h;
      numeric[k] = (barrier(contacts, up, kappa, TestShape::cubic) -
                    barrier(contacts, down, kappa, TestShape::cubic)) /
                   (2 * h);
    }
    best = std::min(best, (numeric - gradient).norm() / gradient.norm());
  }
  return best;
}

/// Central differences of the gradient, best of a ladder against the projected reference. Counts into
/// *n_indefinite whether there was something to clamp.
double projected_error(ContactSystem& contacts, const Scene& scene, const Matrix& hessian,
                       int* n_indefinite) {
  double lowest = 0;
  double best = std::numeric_limits<double>::infinity();
  for (double h : {1e-4, 1e-5, 1e-6}) {
    Matrix numeric(hessian.rows(), hessian.cols());
    for (Eigen::Index k = 0; k < hessian.cols(); ++k) {
      Positions up = scene.x0, down = scene.x0;
      up.data()[k] += h;
      down.data()[k] -= h;
      numeric.col(k) = (assemble(contacts, up, HessianMode::gauss_newton).gradient -
                        assemble(contacts, down, HessianMode::gauss_newton).gradient) /
                       (2 * h);
    }
    for (const Pin& p : scene.pins) {
      numeric.middleRows<3>(3 * p.vertex).setZero();
      numeric.middleCols<3>(3 * p.vertex).setZero();
    }
    const Matrix symmetric = 0.5 * (numeric + numeric.transpose()), reference = clamped(symmetric);
    lowest = eigenvalues(symmetric)[0];
    best = std::min(best, (reference - hessian).norm() / reference.norm());
  }
  *n_indefinite += lowest < -1e-3;
  return best;
}

/// Scenes of exactly one row each, one for every kind, and some with prescribed vertices.
std::vector<Scene> one_row_scenes() {
  const std::vector<Vec3d> triangle{{0, 0, 0}, {1, 0.1, 0}, {0.1, 1, 0.05}};
  std::vector<Scene> scenes;
  for (const Vec3d& p : {Vec3d(0.3, 0.3, 0.08), Vec3d(0.5, -0.03, 0.06), Vec3d(-0.04, -0.05, 0.03)}) {
    for (int given : {0, 1, 2}) {
      Scene scene;
      add_body(scene, "triangle", triangle, {{0, 1, 2}}, 0.2, given == 1);
      add_body(scene, "point", {p}, {}, 0.2, given == 2);
      scenes.push_back(scene);
    }
  }
  Scene edges;
  add_body(edges, "a", {Vec3d(0, 0, 0), Vec3d(1, 0.1, 0)}, {}, 0.2);
  add_body(edges, "b", {Vec3d(0.4, -1, 0.1), Vec3d(0.6, 1, 0.05)}, {}, 0.2);
  edges.surface_edges = {{0, 1}, {2, 3}};
  scenes.push_back(edges);
  for (ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    Scene scene;
    add_body(scene, "point", {Vec3d(0.5, 0.6, 0.45)}, {}, 0.2);
    Obstacle o;
    o.kind = kind;
    o.inside = true;
    o.radius = kind == ObstacleKind::sphere ? 1.0 : 0.9;
    scene.obstacles.push_back(o);
    scenes.push_back(scene);
  }
  return scenes;
}

TEST(ContactTerms, GradientOfEveryKindOfRow) {
  for (const Scene& scene : one_row_scenes()) {
    ContactSystem contacts(scene, {});
    const Assembled terms = assemble(contacts, scene.x0, HessianMode::gauss_newton);
    ASSERT_EQ(terms.n_rows, 1U);
    ASSERT_GT(terms.gradient.norm(), 1e-2);
    EXPECT_LT(gradient_error(contacts, scene, terms.gradient), 1e-8);
  }
}

TEST(ContactTerms, GaussNewtonIsTheRankOnePartAlone) {
  for (const Scene& scene : one_row_scenes()) {
    ContactSystem contacts(scene, {});
    Rows rows = rows_at(contacts, scene.x0);
    evaluate(rows.table, kappa, TestShape::cubic);
    const Assembled terms = assemble(contacts, scene.x0, HessianMode::gauss_newton);
    const double curvature = kappa * rows.table.d2b[0], slope = kappa * rows.table.db[0];
    const VecXd w = terms.gradient / slope;
    EXPECT_GT(curvature, 1.0);
    EXPECT_LT((terms.hessian - curvature * w * w.transpose()).norm(), 1e-13 * terms.hessian.norm());
  }
}

TEST(ContactTerms, ProjectedFullMatchesTheProjectionOfFiniteDifferences) {
  int differ = 0, n_indefinite = 0;
  for (const Scene& scene : one_row_scenes()) {
    // inside a sphere or a cylinder the curvature term is positive: nothing to clamp, checked below
    if (!scene.obstacles.empty()) continue;
    ContactSystem contacts(scene, {});
    const Assembled full = assemble(contacts, scene.x0, HessianMode::projected_full);
    const Assembled plain = assemble(contacts, scene.x0, HessianMode::gauss_newton);
    EXPECT_LT(projected_error(contacts, scene, full.hessian, &n_indefinite), 1e-7);
    differ += (full.hessian - plain.hessian).norm() > 1e-3 * plain.hessian.norm();
  }
  EXPECT_GE(differ, 5);
  EXPECT_GE(n_indefinite, 8);
}

TEST(ContactTerms, FullHessianOfAConcaveObstacleIsExact) {
  int n = 0;
  for (const Scene& scene : one_row_scenes()) {
    if (scene.obstacles.empty()) continue;
    ContactSystem contacts(scene, {});
    const Assembled full = assemble(contacts, scene.x0, HessianMode::projected_full);
    const Assembled plain = assemble(contacts, scene.x0, HessianMode::gauss_newton);
    Matrix numeric(3, 3);
    const double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      Positions up = scene.x0, down = scene.x0;
      up.data()[k] += h;
      down.data()[k] -= h;
      numeric.col(k) = (assemble(contacts, up, HessianMode::gauss_newton).gradient -
                        assemble(contacts, down, HessianMode::gauss_newton).gradient) /
                       (2 * h);
    }
    EXPECT_LT((numeric - full.hessian).norm(), 1e-8 * numeric.norm());
    EXPECT_GT((full.hessian - plain.hessian).norm(), 0.01 * plain.hessian.norm());
    ++n;
  }
  EXPECT_EQ(n, 2);
}

TEST(ContactTerms, GradientOfManyRowsAtOnce) {
  Scene scene;
  const auto [v1, t1] = grid(3, 3, 0.3);
  auto [v2, t2] = grid(3, 3, 0.31, Vec3d(0.013, 0.027, 0.06));
  for (std::size_t i = 0; i < v2.size(); ++i) v2[i][2] += 0.01 * std::sin(3.0 * static_cast<double>(i));
  add_body(scene, "floor", v1, t1, 0.1, true);
  add_body(scene, "cloth", v2, t2, 0.1);
  ContactSystem contacts(scene, {});
  const Assembled terms = assemble(contacts, scene.x0, HessianMode::gauss_newton);
  EXPECT_GT(terms.n_rows, 30U);
  EXPECT_GT(rows_at(contacts, scene.x0).mollified.size(), 3U);
  EXPECT_LT(gradient_error(contacts, scene, terms.gradient), 1e-7);
}

/// Two nearly parallel edges, whose mollifier is far from 0 and from 1.
Scene nearly_parallel(bool given) {
  Scene scene;
  add_body(scene, "a", {Vec3d(0, 0, 0), Vec3d(1, 0, 0)}, {}, 0.2, given);
  add_body(scene, "b", {Vec3d(0.1, -0.01, 0.1), Vec3d(1.1, 0.009, 0.11)}, {}, 0.2);
  scene.surface_edges = {{0, 1}, {2, 3}};
  scene.surface_vertices.clear();  // the pair of edges alone
  return scene;
}

TEST(MollifiedTerms, GradientAndProjectedHessian) {
  int n_indefinite = 0;
  for (bool given : {false, true}) {
    const Scene scene = nearly_parallel(given);
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    ASSERT_EQ(rows.mollified.size(), 1U);
    ASSERT_EQ(rows.table.size(), 0U);
    EXPECT_EQ(rows.mollified.n_free[0], given ? 2 : 4);
    EXPECT_EQ(rows.mollified.vertex[0], given ? -1 : 0);
    EXPECT_EQ(rows.mollified.free_vertex[0], given ? 2 : 0);

    const Assembled terms = assemble(contacts, scene.x0, HessianMode::gauss_newton);
    ASSERT_GT(terms.gradient.norm(), 1e-2);
    EXPECT_LT(gradient_error(contacts, scene, terms.gradient), 1e-7);
    EXPECT_LT(projected_error(contacts, scene, terms.hessian, &n_indefinite), 1e-6);
  }
  EXPECT_EQ(n_indefinite, 2);
}

TEST(MollifiedTerms, ThresholdIsMetWithoutAJump) {
  const Scene scene = nearly_parallel(false);
  ContactSystem contacts(scene, {});
  const auto state = [&](double turn) {
    Positions x = scene.x0;
    x(1, 3) += turn;
    return x;
  };
  // |ea x eb|^2 = (0.019 + turn)^2 + 0.01^2 meets 1e-3 |eb|^2 at rest here:
  const double expected = std::sqrt(1e-3 * (1 + 0.019 * 0.019 + 1e-4) - 1e-4) - 0.019;
  double lo = 0, hi = 0.1;
  for (int k = 0; k < 60; ++k) {
    const double middle = (lo + hi) / 2;
    (rows_at(contacts, state(middle)).mollified.size() == 1 ? lo : hi) = middle;
  }
  EXPECT_NEAR(lo, expected, 1e-12);
  EXPECT_EQ(rows_at(contacts, state(hi)).table.size(), 1U);
  const double below = barrier(contacts, state(lo), kappa), above = barrier(contacts, state(hi), kappa);
  EXPECT_GT(below, 1e-3);
  EXPECT_NEAR(above, below, 1e-12 * below);
}

TEST(MollifiedTerms, NoneWithoutTheMollifier) {
  const Scene scene = nearly_parallel(false);
  ContactSystem contacts(scene, {Mollifier::none});
  const Rows rows = rows_at(contacts, scene.x0);
  EXPECT_EQ(rows.mollified.size(), 0U);
  EXPECT_EQ(rows.table.size(), 1U);
}

}  // namespace
}  // namespace bb::test::contact_terms_test
