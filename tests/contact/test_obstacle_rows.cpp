// Rows of whole primitives against a ball or a bar: exact against sampling, which pairs there are, B and its derivatives.
#include <gtest/gtest.h>

#include "core/contact/pair_name.hpp"
#include "tests/contact/barrier_gradient.hpp"
#include "tests/contact/obstacle_scenes.hpp"
#include "tests/contact/one_feature.hpp"

namespace bb::test::obstacle_rows_test {
namespace {

/// A triangle (or a rod, without triangles) at random about an obstacle, far or near.
Scene random_primitive(ObstacleKind kind, int n, double offset, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto any = [&] { return Vec3d(unit(rng), unit(rng), unit(rng)); };
  Scene scene;
  std::vector<Vec3d> corners;
  const Vec3d middle = 0.9 * any();
  for (int k = 0; k < n; ++k) corners.push_back(middle + 0.6 * any());
  add_body(scene, "body", corners, n == 3 ? Triangles{{0, 1, 2}} : Triangles{}, 2.0, false, offset);
  if (n == 2) scene.surface_edges = {{0, 1}};
  scene.obstacles = {round_obstacle(kind, 0.1 * any(), 0.05 + 0.1 * std::abs(unit(rng)), any().normalized())};
  return scene;
}

bool crosses_axis(const Scene& scene) {
  if (scene.surface_triangles.empty()) return false;
  const Obstacle& o = scene.obstacles[0];
  double turns[3];
  for (int k = 0; k < 3; ++k) {
    const Vec3d a = scene.x0.col(k) - o.point, b = scene.x0.col((k + 1) % 3) - o.point;
    turns[k] = o.axis.dot(a.cross(b));
  }
  return (turns[0] > 0) == (turns[1] > 0) && (turns[1] > 0) == (turns[2] > 0);
}

TEST(ObstacleRows, HaveTheLeastGapOfTheWholePrimitive) {
  int n_kind[3] = {}, n_compared = 0;
  for (unsigned seed = 1; seed <= 600; ++seed) {
    const ObstacleKind kind = seed % 2 == 0 ? ObstacleKind::sphere : ObstacleKind::cylinder;
    const Scene scene = random_primitive(kind, seed % 3 == 0 ? 2 : 3, seed % 5 == 0 ? 0.05 : 0, seed);
    if (kind == ObstacleKind::cylinder && crosses_axis(scene)) continue;
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    const double least = least_gap(scene, scene.x0);
    ASSERT_GT(rows.table.size() + rows.mollified.size(), 0U);
    ASSERT_NEAR(rows.min_gap, least, 1e-9) << "seed " << seed;
    ++n_compared;
    for (const ContactKind k : rows.table.kind) ++n_kind[static_cast<int>(k) - 4];
  }
  EXPECT_GT(n_compared, 400);
  for (const int n : n_kind) EXPECT_GT(n, 8);
}

/// The vertices of a row, in the order of its stencil.
std::vector<int> vertices_of(const ContactTable& t, std::size_t r) {
  std::vector<int> out;
  for (std::size_t k = 0; k < 4 && t.stencil[4 * r + k] >= 0; ++k) out.push_back(t.stencil[4 * r + k]);
  return out;
}

TEST(ObstacleRows, SayWhatTheirColumnsPromise) {
  int n_flat = 0, n_round = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Scene scene = around_obstacles(seed);
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    const ContactTable& t = rows.table;
    for (std::size_t r = 0; r < t.size(); ++r) {
      if (!is_obstacle(t.kind[r])) continue;
      Vec3d foot = Vec3d::Zero();
      double sum = 0;
      const std::vector<int> vertices = vertices_of(t, r);
      ASSERT_EQ(vertices.size(), static_cast<std::size_t>(t.kind[r]) - 3);
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        foot += t.stencil_weight[4 * r + k] * scene.x0.col(vertices[k]);
        sum += t.stencil_weight[4 * r + k];
      }
      EXPECT_NEAR(sum, 1, 1e-14);
      int o = -1;
      for (const int id : t.key(r)) o = id < -1 ? -2 - id : o;
      const Obstacle& obstacle = scene.obstacles[at(o)];
      const Vec3d n = Vec3d::Map(&t.normal[3 * r]), flat = Vec3d::Map(&t.flat[3 * r]);
      EXPECT_NEAR(gap_of_point(obstacle, foot) - thickness(scene, vertices[0]), t.d[r], 1e-13);
      EXPECT_NEAR(gap_of_point(obstacle, foot + 1e-3 * n) - gap_of_point(obstacle, foot), 1e-3, 1e-13);
      EXPECT_NEAR(t.curvature[r], 1 / (gap_of_point(obstacle, foot) + obstacle.radius), 1e-12);
      EXPECT_EQ(flat, obstacle.kind == ObstacleKind::sphere ? Vec3d(Vec3d::Zero()) : obstacle.axis);
      (flat.isZero() ? n_round : n_flat) += 1;
    }
  }
  EXPECT_GT(n_flat, 50);
  EXPECT_GT(n_round, 50);
}

TEST(ObstacleRows, OfABallAreOneAPairOfWhatIsPartOfNothingLarger) {
  // a fan of four triangles over a ball: all of them are closest with their common corner
  Scene scene;
  add_body(scene, "fan",
           {Vec3d(0, 0, 1.05), Vec3d(1, 0, 1.2), Vec3d(0, 4, 1.12), Vec3d(-1, 0, 1.2), Vec3d(0, -4, 1.12)},
           {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}, 0.1);
  scene.obstacles = {round_obstacle(ObstacleKind::sphere, Vec3d::Zero(), 1)};
  ContactSystem contacts(scene, {});
  expect_one_feature(rows_at(contacts, scene.x0), ContactKind::obstacle, 4, 0.05);
  // the same fan over a bar along y: two sides stand across it, two lie nearly along it, and the corner itself
  scene.obstacles = {round_obstacle(ObstacleKind::cylinder, Vec3d::Zero(), 1, Vec3d::UnitY())};
  ContactSystem along(scene, {});
  const Rows at_bar = rows_at(along, scene.x0);
  expect_one_feature(at_bar, ContactKind::obstacle, 3, at_bar.table.d.at(0));
  EXPECT_EQ(at_bar.mollified.size(), 2U);
}

TEST(ObstacleRows, OfConvexSidesAreThoseOfVertices) {
  Scene scene;
  add_body(scene, "triangle", {Vec3d(0, 0, 0.05), Vec3d(0.1, 0, 0.05), Vec3d(0, 0.1, 0.05)}, {{0, 1, 2}},
           0.1);
  Obstacle floor, shell = round_obstacle(ObstacleKind::sphere, Vec3d(0, 0, 2), 2.0);
  shell.inside = true;
  scene.obstacles = {floor, shell};
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  ASSERT_EQ(rows.table.size(), 6U);  // every corner with each
  for (const ContactKind kind : rows.table.kind) EXPECT_EQ(kind, ContactKind::obstacle);
}

TEST(ObstacleRows, OfADiskInThePlaneAreThoseOfEdgesOrWithVertexPairsOfVertices) {
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    Scene scene;
    scene.planar = true;
    add_body(scene, "line", {Vec3d(-1, 1.04, 0), Vec3d(1, 1.04, 0), Vec3d(0, -1.03, 0)}, {}, 0.1);
    scene.surface_edges = {{0, 1}};
    scene.obstacles = {round_obstacle(kind, Vec3d::Zero(), 1)};
    ContactSystem edges(scene, {});
    const Rows rows = rows_at(edges, scene.x0);
    ASSERT_EQ(rows.table.size(), 2U);  // the edge, and the vertex that has none
    EXPECT_NEAR(rows.table.d[find_row(rows.table, {-1, -2, 0, 1}, ContactKind::obstacle_edge)], 0.04, 1e-15);
    EXPECT_NEAR(rows.table.d[find_row(rows.table, {-1, -1, -2, 2}, ContactKind::obstacle)], 0.03, 1e-15);
    EXPECT_EQ(rows.mollified.size(), 0U);
    scene.planar_pairs = PlanarPairs::vertex_vertex;
    ContactSystem vertices(scene, {});
    EXPECT_EQ(rows_at(vertices, scene.x0).table.size(), 1U);
  }
}

TEST(ObstacleRows, GradientAndHessianAreThoseOfB) {
  std::size_t n_mollified = 0, n_kind[3] = {};
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Scene scene = around_obstacles(seed);
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    n_mollified += rows.mollified.size();
    for (const ContactKind k : rows.table.kind) {
      if (is_obstacle(k)) ++n_kind[static_cast<int>(k) - 4];
    }
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(scene.x0.size(), scene.x0.size());
    const VecXd gradient = gradient_of(contacts, scene.x0, &hessian);
    for (int direction = 0; direction < 8; ++direction) {
      VecXd dx = VecXd::Zero(scene.x0.size());
      Positions free =
          random_motion(Positions::Zero(3, scene.n_vertices()), 1, seed + 50U * unsigned(direction));
      for (const Pin& pin : scene.pins) free.col(pin.vertex).setZero();
      dx = VecXd::Map(free.data(), free.size()).normalized();
      double gradient_error = 1, hessian_error = 1;
      for (const double h : {1e-4, 1e-5, 1e-6}) {
        const Positions step = h * Positions::Map(dx.data(), 3, scene.n_vertices());
        const double slope = (barrier(contacts, scene.x0 + step, 3.5, TestShape::cubic) -
                              barrier(contacts, scene.x0 - step, 3.5, TestShape::cubic)) /
                             (2 * h);
        const VecXd bend =
            (gradient_of(contacts, scene.x0 + step) - gradient_of(contacts, scene.x0 - step)) / (2 * h);
        gradient_error = std::min(gradient_error, std::abs(slope - gradient.dot(dx)) / gradient.norm());
        hessian_error = std::min(hessian_error, (bend - hessian * dx).norm() / (hessian * dx).norm());
      }
      EXPECT_LT(gradient_error, 1e-7) << "seed " << seed;
      EXPECT_LT(hessian_error, 1e-5) << "seed " << seed;
    }
  }
  EXPECT_GT(n_mollified, 10U);
  for (const std::size_t n : n_kind) EXPECT_GT(n, 10U);
}

/// A triangle slides over an obstacle, and on a bar turns until a side is along its axis: largest relative change of the
/// gradient of B between states that are `step` apart.
double roughness(ObstacleKind kind, Mollifier mollifier, int n_steps, std::set<ContactKey>& keys) {
  Scene scene;
  add_body(scene, "triangle", {Vec3d(-0.5, -0.3, 1.05), Vec3d(0.5, -0.3, 1.05), Vec3d(0, 0.6, 1.07)},
           {{0, 1, 2}}, 0.2);
  scene.obstacles = {round_obstacle(kind, Vec3d::Zero(), 1, Vec3d::UnitX())};
  ContactOptions options;
  options.mollifier = mollifier;
  ContactSystem contacts(scene, options);
  VecXd last;
  double worst = 0, size = 0;
  for (int k = 0; k <= n_steps; ++k) {
    const double s = 2.0 * k / n_steps - 1;
    Positions x = scene.x0;
    x.row(0).array() += 0.3 * s;
    x.row(1).array() += 0.5 * s;
    const double turn = 0.2 * s;  // about z: at s = 0 a side is along x
    const Mat3d r = Eigen::AngleAxisd(turn, Vec3d::UnitZ()).toRotationMatrix();
    x = r * x;
    for (const ContactKey& key : keys_of(rows_at(contacts, x).table)) keys.insert(key);
    const VecXd g = gradient_of(contacts, x);
    size = std::max(size, g.norm());
    if (k > 0) worst = std::max(worst, (g - last).norm());
    last = g;
  }
  return worst / size;
}

TEST(ObstacleRows, LeaveTheGradientOfBContinuousWhereTheClosestPointChanges) {
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    std::set<ContactKey> keys;
    const double coarse = roughness(kind, Mollifier::ipc, 2000, keys);
    const double fine = roughness(kind, Mollifier::ipc, 20000, keys);
    EXPECT_LT(fine, 0.2 * coarse);  // falls with the steps: no jump
    EXPECT_GE(keys.size(), 3U);
  }
  std::set<ContactKey> keys;
  EXPECT_GT(roughness(ObstacleKind::cylinder, Mollifier::none, 20000, keys), 0.05);  // an edge turns round
}

TEST(ObstacleRows, OfWhatIsGivenAltogetherAreNone) {
  Scene scene = around_obstacles(2);
  scene.pins.clear();
  for (int v = 0; v + 1 < scene.n_vertices(); ++v) scene.pins.push_back({v, 0});
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  int n_obstacle = 0;
  for (std::size_t r = 0; r < rows.table.size(); ++r) {
    if (!is_obstacle(rows.table.kind[r])) continue;
    ++n_obstacle;
    EXPECT_EQ(rows.table.vertex[4 * r], scene.n_vertices() - 1);
  }
  EXPECT_EQ(n_obstacle, 1);  // the free point by the bar
}

TEST(ObstacleStart, NamesWhatTouchesWithItsPrimitiveAndGap) {
  Scene scene;
  add_body(scene, "sheet", {Vec3d(-1, -1, 0.9), Vec3d(1, -1, 0.9), Vec3d(0, 1, 0.9)}, {{0, 1, 2}}, 0.1);
  scene.obstacles = {round_obstacle(ObstacleKind::sphere, Vec3d::Zero(), 1)};
  ContactSystem ball(scene, {});
  const auto overlap = ball.check_initial(scene.x0);
  ASSERT_TRUE(overlap.has_value());
  EXPECT_EQ(overlap->text, "obstacle_triangle: ball, sheet[0], sheet[1], sheet[2]");
  EXPECT_NEAR(overlap->gap, -0.1, 1e-14);
  // a bar so thin that it pierces the triangle far from its sides
  scene.obstacles = {round_obstacle(ObstacleKind::cylinder, Vec3d(0, -0.3, 0), 0.01)};
  ContactSystem bar(scene, {});
  const auto pierced = bar.check_initial(scene.x0);
  ASSERT_TRUE(pierced.has_value());
  EXPECT_EQ(pierced->text, "obstacle_triangle: bar, sheet[0], sheet[1], sheet[2]");
  scene.obstacles[0].point = Vec3d(0, -1.05, 0);
  ContactSystem beside(scene, {});
  EXPECT_FALSE(beside.check_initial(scene.x0).has_value());
  scene.obstacles[0].point = Vec3d(0, -1.005, 0);  // a side is in it
  ContactSystem touched(scene, {});
  const auto side = touched.check_initial(scene.x0);
  ASSERT_TRUE(side.has_value());
  EXPECT_EQ(side->text, "obstacle_edge: bar, sheet[0], sheet[1]");
}

}  // namespace
}  // namespace bb::test::obstacle_rows_test
