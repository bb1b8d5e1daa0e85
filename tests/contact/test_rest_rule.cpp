// Pairs of one body that are close at rest: their rows have a shorter activation distance.
#include <gtest/gtest.h>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test::rest_rule_test {
namespace {

constexpr double d_hat = 0.1;

TEST(RestRule, ShortensTheActivationDistanceOfOneBody) {
  Scene scene;  // one body: a triangle and a vertex 0.06 above it at rest, then closer
  const std::vector<Vec3d> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 0.06}};
  add_body(scene, "body", vertices, {{0, 1, 2}}, d_hat);
  ContactSystem contacts(scene, {});
  EXPECT_EQ(rows_at(contacts, scene.x0).table.size(), 0U);  // 0.06 > 0.06/1.5
  Positions x = scene.x0;
  x(2, 3) = 0.03;
  const Rows rows = rows_at(contacts, x);
  ASSERT_EQ(rows.table.size(), 1U);
  EXPECT_NEAR(rows.table.d_hat[0], 0.04, 1e-15);

  scene.body[3] = 1;  // two bodies: the rule does not hold
  scene.bodies.push_back({"other", 3, 1});
  ContactSystem apart(scene, {});
  const Rows plain = rows_at(apart, x);
  ASSERT_EQ(plain.table.size(), 1U);
  EXPECT_EQ(plain.table.d_hat[0], d_hat);
}

TEST(RestRule, AGridAtRestHasNoRowsHoweverLargeDHatIs) {
  Scene scene;
  const auto [vertices, triangles] = grid(6, 6, 0.1);
  add_body(scene, "cloth", vertices, triangles, 0.5);
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  EXPECT_EQ(rows.table.size() + rows.mollified.size(), 0U);
  const std::size_t at_rest = contacts.candidate_counts().point_triangle;
  const Rows pressed = rows_at(contacts, 0.6 * scene.x0);
  EXPECT_GT(pressed.table.size(), 100U);
  EXPECT_GT(contacts.candidate_counts().point_triangle,
            2 * at_rest);  // nor candidates, but those that touch nearly
}

}  // namespace
}  // namespace bb::test::rest_rule_test
