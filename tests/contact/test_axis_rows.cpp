// Edges beside the axis of a cylinder, in space and in the plane: where they are mollified, that no plan leaves it out, and
// that nothing of them pushes or resists along the axis.
#include <gtest/gtest.h>

#include "tests/contact/barrier_gradient.hpp"
#include "tests/contact/close_bodies.hpp"

namespace bb::test::axis_rows_test {
namespace {

/// An edge, half of d_hat from a bar far from the origin, at a small angle to it. Planar: the axis leans out of the
/// plane by `lean`, a part of a right angle.
Scene beside_bar(unsigned seed, bool planar, double lean, double angle) {
  std::mt19937_64 rng(seed);
  Scene scene;
  scene.planar = planar;
  const double d_hat = 0.02;
  add_piece(scene, Piece::edge, rng, d_hat, false);
  Obstacle o = random_wall(Wall::tilted_bar, rng, planar);
  const double turn = between(rng, 0, 3), up = lean * std::acos(0.0);
  if (planar) o.axis = Vec3d(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up));
  o.point = in_box(rng, 3, planar);
  const Vec3d flat = planar ? Vec3d(std::cos(turn), std::sin(turn), 0) : o.axis;
  const Vec3d n = planar ? Vec3d(-std::sin(turn), std::cos(turn), 0) : Vec3d(o.axis.unitOrthogonal());
  const Vec3d along = std::cos(angle) * flat + std::sin(angle) * (planar ? n : Vec3d(n.cross(flat)));
  const double gap = 0.5 * d_hat + (scene.offset[0] + scene.offset[1]) / 2;
  const double foot = o.radius + gap + (planar ? 0.5 * std::sin(std::abs(angle)) : 0);
  scene.x0.col(0) = o.point + foot * n - 0.4 * along;
  scene.x0.col(1) = o.point + foot * n + 0.5 * along;
  scene.rest = scene.x0;
  scene.obstacles = {o};
  return scene;
}

ContactPlan everything(const Scene& scene) {
  ContactPlan plan = plan_contact(scene);
  plan.broad_phase.needed = plan.obstacles.needed = plan.mollifier.needed = true;
  plan.point_edge = plan.point_edge || !(scene.planar && scene.planar_pairs == PlanarPairs::vertex_vertex);
  plan.point_triangle = plan.edge_edge = !scene.planar;
  return plan;
}

struct Counts {
  std::size_t plain = 0, mollified = 0;
};

/// Rows with the plan of the scene are those with a plan that leaves nothing out.
Counts expect_nothing_left_out(const Scene& scene) {
  ContactSystem planned(scene, {}), all(scene, {}, everything(scene));
  const Rows found = rows_at(planned, scene.x0), expected = rows_at(all, scene.x0);
  EXPECT_EQ(found.table.d, expected.table.d);
  EXPECT_EQ(found.table.pair, expected.table.pair);
  EXPECT_EQ(found.mollified.d, expected.mollified.d);
  EXPECT_EQ(found.mollified.eps, expected.mollified.eps);
  EXPECT_EQ(found.min_gap, expected.min_gap);
  return {found.table.size(), found.mollified.size()};
}

TEST(AxisRows, NoPlanLeavesOutAnyRowOfAnyScene) {
  Counts sum;
  const auto add = [&sum](const Scene& scene) {
    const Counts one = expect_nothing_left_out(scene);
    sum.plain += one.plain, sum.mollified += one.mollified;
  };
  for_each_close_scene(2, 500, [&](const CloseBodies& bodies) { add(bodies.scene); });
  for (unsigned seed = 1; seed <= 60; ++seed) add(near_parallel(seed, seed % 16).scene);
  for (unsigned seed = 1; seed <= 20; ++seed) add(mixed_scene(seed, seed % 2 == 0, 10));
  EXPECT_GT(sum.plain, 500U);
  EXPECT_GT(sum.mollified, 30U);
}

/// A bar that lies in the plane is a line there, and an edge turns parallel to it; one that stands on it is a disk.
TEST(AxisRows, InThePlaneAnEdgeAlongABarIsMollifiedAndOneAtADiskIsNot) {
  int lying = 0, standing = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    for (const double angle : {0.0, 1e-3, -0.01, 0.1}) {
      const Scene bar = beside_bar(seed, true, 0, angle);
      const Counts along = expect_nothing_left_out(bar);
      EXPECT_EQ(along.mollified, std::abs(angle) < 0.03 ? 1U : 0U) << seed << " " << angle;
      EXPECT_TRUE(plan_contact(bar).mollifier.needed);
      EXPECT_FALSE(plan_contact(bar, Mollifier::none).mollifier.needed);
      lying += along.mollified > 0;
      const Scene disk = beside_bar(seed, true, 1, angle);
      EXPECT_EQ(expect_nothing_left_out(disk).mollified, 0U);
      EXPECT_FALSE(plan_contact(disk).mollifier.needed);
      standing += expect_nothing_left_out(disk).plain > 0;
    }
  }
  EXPECT_EQ(lying, 180);
  EXPECT_GT(standing, 100);
  // a cylinder stands on the plane while its axis leans by less than 60 degrees out of the normal
  for (const double lean : {0.0, 0.2, 0.32, 0.34, 0.5, 1.0})
    EXPECT_EQ(plan_contact(beside_bar(1, true, lean, 0)).mollifier.needed, lean < 1.0 / 3) << lean;
}

/// B does not change along the axis: neither its gradient nor its Hessian has a part there, for either end.
TEST(AxisRows, NothingPushesOrResistsAlongTheAxis) {
  int mollified = 0, stiff = 0;
  for (unsigned seed = 1; seed <= 80; ++seed) {
    std::mt19937_64 rng(seed);
    Scene scene = beside_bar(seed, seed % 4 == 0, 0, std::pow(10.0, between(rng, -4, -1.6)));
    if (seed % 3 == 0) {
      scene.pins = {{static_cast<int>(rng() % 2), 0}};
      scene.motions.push_back({});
    }
    ContactSystem contacts(scene, {});
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(scene.x0.size(), scene.x0.size());
    const VecXd gradient = gradient_of(contacts, scene.x0, &hessian);
    const double force = gradient.cwiseAbs().maxCoeff(), size = hessian.cwiseAbs().maxCoeff();
    ASSERT_GT(force, 0);
    for (int v = 0; v < scene.n_vertices(); ++v) {
      VecXd along = VecXd::Zero(gradient.size());
      along.segment<3>(3 * v) = scene.obstacles[0].axis;
      EXPECT_LT(std::abs(gradient.dot(along)), 1e-12 * force) << seed;
      EXPECT_LT((hessian * along).cwiseAbs().maxCoeff(), 1e-10 * size) << seed;
    }
    const Rows rows = rows_at(contacts, scene.x0);
    mollified += rows.mollified.size() > 0;
    stiff += size > 0;
  }
  EXPECT_GT(mollified, 30);
  EXPECT_EQ(stiff, 80);
}

/// The Hessian is what the gradient changes by, in every direction.
TEST(AxisRows, TheHessianIsTheChangeOfTheGradient) {
  int mollified = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937_64 rng(seed);
    const Scene scene = beside_bar(seed, seed % 4 == 0, 0, std::pow(10.0, between(rng, -2.5, -1.6)));
    ContactSystem contacts(scene, {});
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(scene.x0.size(), scene.x0.size());
    gradient_of(contacts, scene.x0, &hessian);
    const double step = 1e-8;
    Positions way = random_motion(Positions::Zero(3, 2), 1, seed);
    if (scene.planar) way.row(2).setZero();
    const VecXd change =
        (gradient_of(contacts, scene.x0 + step * way) - gradient_of(contacts, scene.x0 - step * way)) /
        (2 * step);
    const VecXd expected = hessian * Eigen::Map<const VecXd>(way.data(), way.size());
    EXPECT_LT((change - expected).norm(), 1e-4 * expected.norm()) << seed;
    mollified += rows_at(contacts, scene.x0).mollified.size() > 0;
  }
  EXPECT_GT(mollified, 40);
}

}  // namespace
}  // namespace bb::test::axis_rows_test
