// What driven vertices add to the right-hand side of the free ones: that of the Hessian of the same scene in which nobody
// is given, whatever slots of a row the prescribed vertices stand in.
#include <gtest/gtest.h>

#include "core/math/lower_blocks.hpp"
#include "tests/contact/close_bodies.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::given_motion_test {
namespace {

void evaluate_both(Rows& rows) {
  evaluate(rows.table, 3.5, TestShape::cubic);
  evaluate(rows.mollified, 3.5, TestShape::cubic);
}

/// The Hessian times a motion: of rows m kappa b'' w_i w_j n n^T, of mollified ones all of it.
VecXd hessian_times(const Scene& scene, const Positions& motion) {
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, scene.x0);
  evaluate_both(rows);
  VecXd out = VecXd::Zero(motion.size());
  std::vector<double> grad, hess;
  const auto add = [&](const std::vector<int>& vertex, std::size_t n) {
    for (std::size_t r = 0; r < n; ++r) {
      const Eigen::MatrixXd h = from_lower_blocks(&hess[n_lower_numbers(4) * r], 4);
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          const int vi = vertex[4 * r + at(i)], vj = vertex[4 * r + at(j)];
          if (vi >= 0 && vj >= 0) out.segment<3>(3 * vi) += h.block<3, 3>(3 * i, 3 * j) * motion.col(vj);
        }
      }
    }
  };
  contact_terms(rows.table, scene.x0, HessianMode::gauss_newton, Projection::none, grad, hess);
  add(rows.table.vertex, rows.table.size());
  mollified_terms(rows.mollified, scene.x0, Projection::none, grad, hess);
  add(rows.mollified.free_vertex, rows.mollified.size());
  return out;
}

struct Tally {
  int scenes = 0, given_first = 0, mollified = 0, axes = 0, kinds[7] = {};
};

void count(const Rows& rows, Tally& tally) {
  const ContactTable& t = rows.table;
  for (std::size_t r = 0; r < t.size(); ++r) {
    int n = 0;
    while (n < 4 && t.stencil[4 * r + at(n)] >= 0) ++n;
    if (t.n_free[r] == n) continue;
    ++tally.kinds[static_cast<int>(t.kind[r])];
    tally.given_first += t.stencil[4 * r] != t.vertex[4 * r];
  }
  for (std::size_t r = 0; r < rows.mollified.size(); ++r) {
    if (rows.mollified.n_free[r] == (rows.mollified.of_axis(r) ? 2 : 4)) continue;
    ++(rows.mollified.of_axis(r) ? tally.axes : tally.mollified);
  }
}

void expect_hessian(const Scene& scene, unsigned seed, Tally& tally) {
  Scene nobody = scene;
  nobody.pins.clear();
  Positions motion = Positions::Zero(3, scene.n_vertices());
  std::vector<std::uint8_t> free(at(scene.n_vertices()), 1);
  std::mt19937_64 rng(seed);
  for (const Pin& pin : scene.pins) {
    free[at(pin.vertex)] = 0;
    motion.col(pin.vertex) = in_box(rng, 0.01, scene.planar);
  }
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, scene.x0);
  evaluate_both(rows);
  Positions force = Positions::Zero(3, scene.n_vertices());
  add_given_motion(rows.table, motion, force);
  add_given_motion(rows.mollified, scene.x0, motion, force);
  const VecXd expected = hessian_times(nobody, motion);
  if (expected.isZero(0)) return;
  const double scale = expected.cwiseAbs().maxCoeff();
  for (int v = 0; v < scene.n_vertices(); ++v) {
    const Vec3d wanted = free[at(v)] != 0 ? Vec3d(expected.segment<3>(3 * v)) : Vec3d(Vec3d::Zero());
    ASSERT_LT((force.col(v) - wanted).norm(), 1e-9 * scale) << "seed " << seed << " vertex " << v;
  }
  ++tally.scenes;
  count(rows, tally);
}

TEST(GivenMotion, AddsTheHessianTimesTheMotionWhateverVerticesAreGiven) {
  Tally tally;
  unsigned seed = 1;
  for_each_close_scene(12, 300, [&](CloseBodies bodies) {
    if (bodies.pairs.empty()) return;
    Scene& scene = bodies.scene;
    scene.pins.clear();
    std::mt19937_64 rng(++seed);
    for (double& d : scene.d_hat) d *= rng() % 2 ? 1 : 20;
    for (int v = 0; v < scene.n_vertices(); ++v) {
      if (rng() % 2) scene.pins.push_back({v, 0});
    }
    if (scene.motions.empty()) scene.motions.push_back({});
    expect_hessian(scene, seed, tally);
  });
  for (unsigned k = 1; k <= 120; ++k) expect_hessian(near_parallel(k, k % 16).scene, k, tally);
  for (unsigned k = 1; k <= 20; ++k) expect_hessian(mixed_scene(k, k % 4 == 0, 5), k, tally);
  EXPECT_GT(tally.scenes, 200);
  EXPECT_GT(tally.given_first, 100);
  EXPECT_GT(tally.mollified, 20);
  EXPECT_GT(tally.axes, 5);
  for (const ContactKind kind :
       {ContactKind::point_point, ContactKind::point_edge, ContactKind::point_triangle,
        ContactKind::edge_edge, ContactKind::obstacle_edge, ContactKind::obstacle_triangle})
    EXPECT_GT(tally.kinds[static_cast<int>(kind)], 5) << static_cast<int>(kind);
}

}  // namespace
}  // namespace bb::test::given_motion_test
