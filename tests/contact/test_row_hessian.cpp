// The Hessian of a row in its few directions against the whole 12 x 12 matrix, projected in long double.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <map>

#include "core/contact/pair_geometry.hpp"
#include "core/geometry/distance_derivatives.hpp"
#include "core/math/lower_blocks.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/oracle/dense.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::row_hessian_test {
namespace {

using LongMatrix = MatXl;
constexpr double d_hat = 0.05;
constexpr HessianMode numeric_modes[] = {HessianMode::projected_numeric, HessianMode::projected_lapack,
                                         HessianMode::projected_low_rank};

/// m kappa b'' grad d grad d^T + m kappa b' grad^2 d of a row on its free points, straight from the formulas.
template <PairKind K>
LongMatrix whole_hessian(const ContactTable& t, std::size_t r, const Positions& x, Region interior) {
  constexpr int n = pair_points(K);
  std::array<int, n> vertex;
  Closest<double, n> closest;
  for (int k = 0; k < n; ++k) {
    vertex[at(k)] = t.stencil[4 * r + at(k)];
    closest.weights[k] = t.stencil_weight[4 * r + at(k)];
  }
  closest.d = t.d[r] + t.offset[r];
  closest.r = closest.d * Vec3d::Map(&t.normal[3 * r]);
  closest.region = interior;
  const auto d = distance_derivatives<double, n>(gather(x, vertex), closest);
  const Long scale = t.kappa[r];
  const LongMatrix gradient = d.gradient.template cast<Long>();
  const LongMatrix full = scale * t.d2b[r] * (gradient * gradient.transpose()) +
                          scale * t.db[r] * d.hessian.template cast<Long>();
  LongMatrix out = LongMatrix::Zero(12, 12);
  std::vector<int> slots;
  for (int k = 0; k < n; ++k) {
    if (slots.size() < 4 && vertex[at(k)] == t.vertex[4 * r + slots.size()]) slots.push_back(k);
  }
  for (std::size_t j = 0; j < slots.size(); ++j) {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      out.block(3 * Eigen::Index(i), 3 * Eigen::Index(j), 3, 3) =
          full.block(3 * slots[i], 3 * slots[j], 3, 3);
    }
  }
  return out;
}

/// That of a row of an obstacle and N vertices: the pair of a point, the foot less d n, with the vertices across the axis;
/// what the derivatives have along the axis is cut off.
template <int N>
LongMatrix obstacle_hessian(const ContactTable& t, std::size_t r, const Positions& x) {
  const Vec3d axis = Vec3d::Map(&t.flat[3 * r]), n = Vec3d::Map(&t.normal[3 * r]);
  const Mat3d across = Mat3d::Identity() - axis * axis.transpose();
  Mat<double, 3, N + 1> points;
  Closest<double, N + 1> closest;
  closest.weights[0] = 1;
  closest.d = t.d[r] + t.offset[r];
  closest.r = -closest.d * n;
  closest.region = N == 2 ? Region::p_e : Region::p_t;
  points.col(0) = closest.r;
  for (int k = 0; k < N; ++k) {
    points.col(k + 1) = across * x.col(t.stencil[4 * r + at(k)]);
    closest.weights[k + 1] = -t.stencil_weight[4 * r + at(k)];
    points.col(0) -= closest.weights[k + 1] * points.col(k + 1);
  }
  const auto d = distance_derivatives<double, N + 1>(points, closest);
  const Long scale = t.kappa[r];
  LongMatrix out = LongMatrix::Zero(12, 12);
  for (int j = 0, sj = 0; j < N; ++j) {
    if (sj == t.n_free[r] || t.stencil[4 * r + at(j)] != t.vertex[4 * r + at(sj)]) continue;
    for (int i = 0, si = 0; i < N; ++i) {
      if (si == t.n_free[r] || t.stencil[4 * r + at(i)] != t.vertex[4 * r + at(si)]) continue;
      const Vec3d gi = d.gradient.template segment<3>(3 * i + 3),
                  gj = d.gradient.template segment<3>(3 * j + 3);
      const Mat3d curved = across * d.hessian.template block<3, 3>(3 * i + 3, 3 * j + 3) * across;
      const Mat3d block = t.d2b[r] * gi * gj.transpose() + t.db[r] * curved;
      out.block(3 * si, 3 * sj, 3, 3) = scale * block.cast<Long>();
      ++si;
    }
    ++sj;
  }
  return out;
}

LongMatrix whole_hessian(const ContactTable& t, std::size_t r, const Positions& x) {
  switch (t.kind[r]) {
    case ContactKind::point_point:
      return whole_hessian<PairKind::point_point>(t, r, x, Region::p_p);
    case ContactKind::point_edge:
      return whole_hessian<PairKind::point_edge>(t, r, x, Region::p_e);
    case ContactKind::point_triangle:
      return whole_hessian<PairKind::point_triangle>(t, r, x, Region::p_t);
    case ContactKind::edge_edge:
      return whole_hessian<PairKind::edge_edge>(t, r, x, Region::ea_eb);
    case ContactKind::obstacle_edge:
      return obstacle_hessian<2>(t, r, x);
    case ContactKind::obstacle_triangle:
      return obstacle_hessian<3>(t, r, x);
    case ContactKind::obstacle:
      break;
  }
  LongMatrix out = LongMatrix::Zero(12, 12);
  const Long scale = t.kappa[r];
  const Eigen::Matrix<Long, 3, 1> n = Vec3d::Map(&t.normal[3 * r]).cast<Long>(),
                                  flat = Vec3d::Map(&t.flat[3 * r]).cast<Long>();
  const Eigen::Matrix<Long, 3, 3> one = Eigen::Matrix<Long, 3, 3>::Identity();
  out.topLeftCorner(3, 3) =
      scale * t.d2b[r] * (n * n.transpose()) +
      scale * t.db[r] * t.curvature[r] * (one - n * n.transpose() - flat * flat.transpose());
  return out;
}

LongMatrix projected(const LongMatrix& h, Projection projection, Long* lowest) {
  Spectrum own = spectrum(h);
  VecXl& values = own.values;
  *lowest = values(0) / std::max(std::abs(values(0)), std::abs(values(11)));
  if (projection == Projection::none) return h;
  for (Eigen::Index k = 0; k < 12; ++k) {
    if (values(k) < 0) values(k) = projection == Projection::psd ? 0 : -values(k);
  }
  return compose(own.vectors, values, own.vectors);
}

/// Soups with free and prescribed vertices of several sizes of triangles, and obstacles of every kind.
Scene mixed_scene(unsigned seed) {
  Scene scene;
  const auto [v1, t1] = soup(60, 0.2, seed);
  const auto [v2, t2] = soup(60, 0.06, seed + 50);
  const auto [v3, t3] = soup(40, 0.2, seed + 90);
  add_body(scene, "free", v1, t1, d_hat);
  add_body(scene, "small", v2, t2, d_hat, false, 0.01);
  add_body(scene, "half given", v3, t3, d_hat);
  for (int v = 300; v < 480; ++v) {
    if (v % 4 != 0) scene.pins.push_back({v, 0});
  }
  scene.motions.push_back({});
  for (const ObstacleKind kind : {ObstacleKind::plane, ObstacleKind::sphere, ObstacleKind::cylinder}) {
    Obstacle obstacle;
    obstacle.kind = kind;
    obstacle.point = Vec3d(0, 0, -1.1);
    obstacle.radius = 0.9;
    obstacle.inside = kind == ObstacleKind::cylinder;
    scene.obstacles.push_back(obstacle);
  }
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    Obstacle obstacle;
    obstacle.kind = kind;
    obstacle.point = Vec3d(0, 0, kind == ObstacleKind::sphere ? 5 : 8);
    obstacle.axis = Vec3d(2, 1, 2) / 3.0;
    obstacle.radius = 0.3;
    const Vec3d axis = kind == ObstacleKind::sphere ? Vec3d(Vec3d::Zero()) : obstacle.axis;
    const int first = scene.n_vertices();
    add_tangent_triangles(scene, "tangent", obstacle.point, obstacle.radius, axis, d_hat, seed);
    for (int v = first; v < scene.n_vertices(); v += 4) scene.pins.push_back({v, 0});
    scene.obstacles.push_back(obstacle);
  }
  return scene;
}

struct Counts {
  std::map<std::pair<ContactKind, int>, int> rows;  // by kind and number of free points
  int indefinite = 0;
};

void expect_the_whole_matrix(HessianMode mode, Projection projection, Counts* counts) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Scene scene = mixed_scene(seed);
    ContactSystem contacts(scene, {Mollifier::none});
    Rows rows = rows_at(contacts, scene.x0);
    ContactTable& t = rows.table;
    evaluate(t, 3.5, TestShape::cubic);
    std::vector<double> grad, hess;
    contact_terms(t, scene.x0, mode, projection, grad, hess);
    for (std::size_t r = 0; r < t.size(); ++r) {
      if (t.d[r] <= 1e-6) continue;
      Long lowest = 0;
      const LongMatrix expected = projected(whole_hessian(t, r, scene.x0), projection, &lowest);
      const LongMatrix found = from_lower_blocks(&hess[n_lower_numbers(4) * r], 4).cast<Long>();
      ASSERT_GT(expected.norm(), 0);
      EXPECT_LE((found - expected).norm(), 1e-12L * expected.norm()) << r;
      ++counts->rows[{t.kind[r], t.n_free[r]}];
      counts->indefinite += lowest < -1e-3L;
    }
  }
}

TEST(RowHessian, IsTheWholeMatrixWithProjectedEigenvalues) {
  for (const Projection projection : {Projection::none, Projection::psd, Projection::absolute}) {
    Counts counts;
    expect_the_whole_matrix(HessianMode::projected_full, projection, &counts);
    for (const HessianMode mode : numeric_modes) {
      Counts numeric;
      expect_the_whole_matrix(mode, projection, &numeric);
      EXPECT_EQ(numeric.rows, counts.rows);
    }
    for (int n_free = 1; n_free <= 4; ++n_free) {
      const auto seen = [&](ContactKind kind) { return counts.rows[{kind, n_free}]; };
      EXPECT_GT(seen(ContactKind::point_triangle), 1) << n_free;
      EXPECT_GT(seen(ContactKind::edge_edge), 2) << n_free;
      EXPECT_EQ(seen(ContactKind::point_edge) > 5, n_free < 4) << n_free;
      EXPECT_EQ(seen(ContactKind::point_point) > 0, n_free < 3) << n_free;
    }
    EXPECT_GT((counts.rows[{ContactKind::obstacle, 1}]), 20);
    for (const int n_free : {1, 2}) EXPECT_GT((counts.rows[{ContactKind::obstacle_edge, n_free}]), 5);
    for (const int n_free : {2, 3}) EXPECT_GT((counts.rows[{ContactKind::obstacle_triangle, n_free}]), 2);
    EXPECT_GT(counts.indefinite, 200);
  }
}

/// Row r alone, all columns of it.
ContactTable one_row(const ContactTable& t, std::size_t r) {
  ContactTable out;
  out.resize(1);
  const auto copy = [r](const auto& from, auto& to, std::size_t width) {
    for (std::size_t k = 0; k < width; ++k) to[k] = from[width * r + k];
  };
  copy(t.kind, out.kind, 1);
  for (const auto column : {&ContactTable::stencil, &ContactTable::vertex}) copy(t.*column, out.*column, 4);
  for (const auto column : {&ContactTable::stencil_weight, &ContactTable::weight})
    copy(t.*column, out.*column, 4);
  copy(t.n_free, out.n_free, 1);
  for (const auto column : {&ContactTable::normal, &ContactTable::flat}) copy(t.*column, out.*column, 3);
  for (const auto column :
       {&ContactTable::d, &ContactTable::d_hat, &ContactTable::offset, &ContactTable::kappa, &ContactTable::b,
        &ContactTable::db, &ContactTable::d2b, &ContactTable::curvature})
    copy(t.*column, out.*column, 1);
  return out;
}

TEST(RowHessian, DependsOnNoOtherRowAndOnNoThread) {
  const Scene scene = mixed_scene(1);
  ContactSystem contacts(scene, {Mollifier::none});
  Rows rows = rows_at(contacts, scene.x0);
  evaluate(rows.table, 3.5, TestShape::cubic);
  for (const HessianMode mode :
       {HessianMode::gauss_newton, HessianMode::projected_full, HessianMode::projected_numeric,
        HessianMode::projected_lapack, HessianMode::projected_low_rank}) {
    std::vector<double> grad, hess, alone_grad, alone;
    contact_terms(rows.table, scene.x0, mode, Projection::psd, grad, hess);
    ASSERT_GT(rows.table.size(), 100U);
    for (std::size_t r = 0; r < rows.table.size(); ++r) {
      contact_terms(one_row(rows.table, r), scene.x0, mode, Projection::psd, alone_grad, alone);
      for (std::size_t k = 0; k < alone.size(); ++k) ASSERT_EQ(alone[k], hess[alone.size() * r + k]) << r;
      for (std::size_t k = 0; k < 12; ++k) ASSERT_EQ(alone_grad[k], grad[12 * r + k]) << r;
    }
    for (const std::size_t threads : {1, 3}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      std::vector<double> again_grad, again;
      contact_terms(rows.table, scene.x0, mode, Projection::psd, again_grad, again);
      EXPECT_EQ(again, hess);
      EXPECT_EQ(again_grad, grad);
    }
  }
}

}  // namespace
}  // namespace bb::test::row_hessian_test
