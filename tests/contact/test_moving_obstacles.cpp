// An obstacle that moves is a prescribed vertex: its rows, the bound of a motion past it and what its motion adds to the
// right-hand side are those of the same obstacle at rest, seen from it.
#include <gtest/gtest.h>

#include "tests/contact/close_bodies.hpp"
#include "tests/contact/moving_obstacles.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::moving_obstacles_test {
namespace {

/// A body at each kind of wall, of every shape, in space and in the plane; f(scene, seed).
template <class F>
void for_each_wall(const F& f) {
  unsigned seed = 9000;
  for (const bool planar : {false, true}) {
    for (const Piece piece : all_pieces) {
      for (const Wall wall : all_walls) {
        if (planar && wall == Wall::tilted_bar) continue;
        for (int k = 0; k < 6; ++k, ++seed) {
          const CloseBodies close = close_to_wall(piece, wall, 3e-3, seed, planar);
          if (!close.pairs.empty()) f(close.scene, seed);
        }
      }
    }
  }
  for (unsigned k = 3; k <= 60; k += 3) {  // rods that are nearly parallel to a bar
    const Scene scene = near_parallel(k).scene;
    if (!scene.obstacles.empty()) f(scene, k);
  }
}

/// Columns of the vertices that both scenes have, then those of the obstacles.
Positions with_obstacles_at(const Scene& moving, const Positions& x, const Vec3d& moved) {
  Positions out = moving.x0;
  out.leftCols(x.cols()) = x;
  for (const Obstacle& o : moving.obstacles) out.col(o.vertex) = o.point + moved;
  return out;
}

TEST(MovingObstacles, HaveTheRowsOfTheSameObstacleAtRestThere) {
  std::size_t n_rows = 0, n_mollified = 0;
  for_each_wall([&](Scene scene, unsigned seed) {
    std::mt19937_64 rng(seed);
    const Vec3d moved = in_box(rng, 0.3, scene.planar);
    const Scene moving = with_moving_obstacles(scene);
    const Positions at_rest = scene.x0.colwise() + moved;
    for (Obstacle& o : scene.obstacles) o.point += moved;
    ContactSystem still(scene, {}), driven(moving, {});
    const Rows expected = rows_at(still, at_rest);
    const Rows found = rows_at(driven, with_obstacles_at(moving, at_rest, moved));
    EXPECT_EQ(found.min_gap, expected.min_gap);
    ASSERT_EQ(found.table.pair, expected.table.pair);
    for (std::size_t r = 0; r < found.table.size(); ++r) EXPECT_EQ(found.table.key(r), expected.table.key(r));
    EXPECT_EQ(found.table.vertex, expected.table.vertex);
    EXPECT_EQ(found.table.normal, expected.table.normal);
    EXPECT_EQ(found.table.weight, expected.table.weight);
    EXPECT_EQ(found.mollified.axis_point, expected.mollified.axis_point);
    EXPECT_EQ(found.mollified.normal, expected.mollified.normal);
    for (std::size_t r = 0; r < found.table.size(); ++r) {
      double sum = 0;
      for (std::size_t k = 4 * r; k < 4 * r + 4; ++k) sum += found.table.stencil_weight[k];
      EXPECT_NEAR(sum, 0, 1e-15) << "relative motion opens the gap";
    }
    n_rows += found.table.size();
    n_mollified += found.mollified.size();
  });
  EXPECT_GT(n_rows, 200U);
  EXPECT_GT(n_mollified, 5U);
}

TEST(MovingObstacles, StopAMotionWhenTheSameMotionRelativeToThemIsStopped) {
  int n_bounded = 0, n = 0;
  for_each_wall([&](const Scene& scene, unsigned seed) {
    std::mt19937_64 rng(seed);
    const Vec3d moved = in_box(rng, 0.2, scene.planar);
    Positions relative = scene.x0;
    for (Eigen::Index v = 0; v < relative.cols(); ++v) relative.col(v) += in_box(rng, 0.05, scene.planar);
    const Scene moving = with_moving_obstacles(scene);
    const Positions end = relative.colwise() + moved;
    ContactSystem still(scene, {}), driven(moving, {});
    if (!(rows_at(still, scene.x0).min_gap > 0)) return;
    still.update_candidates(scene.x0, relative);
    const Positions x0 = with_obstacles_at(moving, scene.x0, Vec3d::Zero());
    const Positions x1 = with_obstacles_at(moving, end, moved);
    driven.update_candidates(x0, x1);
    const StepBound expected = still.step_bound(scene.x0, relative), found = driven.step_bound(x0, x1);
    EXPECT_NEAR(found.alpha, expected.alpha, 1e-6);
    if (expected.alpha < 1) {
      EXPECT_EQ(is_obstacle(found.kind), is_obstacle(expected.kind));
    }
    n_bounded += expected.alpha < 1;
    ++n;
    const Positions along = with_obstacles_at(moving, scene.x0.colwise() + moved, moved);
    driven.update_candidates(x0, along);
    EXPECT_EQ(driven.step_bound(x0, along).alpha, 1) << "all move as one";
  });
  EXPECT_GT(n_bounded, n / 4);
}

TEST(MovingObstacles, PassNothingBetweenTheirPoses) {
  for (const Wall wall : {Wall::ball, Wall::bar}) {  // from afar, through the body and out on its other side
    const CloseBodies close = close_to_wall(Piece::sheet, wall, 3e-3, 5);
    const Scene moving = with_moving_obstacles(close.scene);
    const Vec3d way = 2 * (close.scene.x0.rowwise().mean() - close.scene.obstacles[0].point);
    const Positions x0 = with_obstacles_at(moving, close.scene.x0, -way);
    const Positions x1 = with_obstacles_at(moving, close.scene.x0, 3 * way);
    ContactSystem contacts(moving, {});
    contacts.update_candidates(x0, x1);
    const StepBound bound = contacts.step_bound(x0, x1);
    EXPECT_TRUE(is_obstacle(bound.kind));
    EXPECT_GT(bound.alpha, 0.2);
    EXPECT_LT(bound.alpha, 0.35) << "3 mm beyond the first quarter";
  }
}

/// The Hessian of all rows times a motion of every free vertex by `moved`.
Positions hessian_times(const Scene& scene, const Positions& x, const Vec3d& moved) {
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, x);
  evaluate(rows.table, 3.5, TestShape::cubic);
  evaluate(rows.mollified, 3.5, TestShape::cubic);
  Positions out = Positions::Zero(3, scene.n_vertices());
  std::vector<double> grad, hess;
  const auto add = [&](const std::vector<int>& vertex, std::size_t n) {
    for (std::size_t r = 0; r < n; ++r) {
      const Eigen::MatrixXd h = from_lower_blocks(&hess[n_lower_numbers(4) * r], 4);
      for (int i = 0; i < 4; ++i) {
        if (vertex[4 * r + at(i)] < 0) continue;
        for (int j = 0; j < 4; ++j) {
          if (vertex[4 * r + at(j)] >= 0)
            out.col(vertex[4 * r + at(i)]) += h.block<3, 3>(3 * i, 3 * j) * moved;
        }
      }
    }
  };
  contact_terms(rows.table, x, HessianMode::gauss_newton, Projection::none, grad, hess);
  add(rows.table.vertex, rows.table.size());
  mollified_terms(rows.mollified, x, Projection::none, grad, hess);
  add(rows.mollified.free_vertex, rows.mollified.size());
  return out;
}

TEST(MovingObstacles, AddToTheRightHandSideWhatTheOppositeMotionOfTheBodyWould) {
  int compared = 0, mollified = 0;
  for_each_wall([&](const Scene& scene, unsigned seed) {
    std::mt19937_64 rng(seed);
    const Vec3d moved = in_box(rng, 0.01, scene.planar);
    const Scene moving = with_moving_obstacles(scene);
    ContactSystem contacts(moving, {});
    Rows rows = rows_at(contacts, moving.x0);
    evaluate(rows.table, 3.5, TestShape::cubic);
    evaluate(rows.mollified, 3.5, TestShape::cubic);
    Positions motion = Positions::Zero(3, moving.n_vertices()), force = motion;
    motion.col(moving.obstacles[0].vertex) = moved;
    add_given_motion(rows.table, motion, force);
    add_given_motion(rows.mollified, moving.x0, motion, force);
    const Positions expected = hessian_times(scene, scene.x0, -moved);
    if (expected.isZero(0)) return;
    EXPECT_LT((force.leftCols(expected.cols()) - expected).norm(), 1e-12 * expected.norm()) << seed;
    EXPECT_TRUE(force.col(moving.obstacles[0].vertex).isZero(0));
    ++compared;
    mollified += rows.mollified.size() > 0;
  });
  EXPECT_GT(compared, 150);
  EXPECT_GT(mollified, 3);
}

}  // namespace
}  // namespace bb::test::moving_obstacles_test
