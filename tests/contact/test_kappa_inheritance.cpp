// A row that continues a contact on a neighbouring feature keeps its stiffness, so that B does not jump
// there.
#include <gtest/gtest.h>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {
namespace {

// A point (vertex 0) above two triangles that share the edge x = 0.
Scene point_over_fan() {
  Scene scene;
  add_body(scene, "point", {Vec3d(0, 0, 0.05)}, {}, 0.1);
  scene.surface_vertices = {0};
  add_body(scene, "fan", {Vec3d(0, -1, 0), Vec3d(0, 1, 0), Vec3d(-1, 0, 0), Vec3d(1, 0, 0)},
           {{0, 1, 2}, {0, 3, 1}}, 0.1);
  return scene;
}

Rows at(ContactSystem& contacts, const Scene& scene, double x) {
  Positions moved = scene.x0;
  moved(0, 0) = x;
  return rows_at(contacts, moved);
}

// B with the quadratic (d_hat - d)^2.
double barrier_energy(const Rows& rows) {
  double energy = 0;
  for (std::size_t r = 0; r < rows.table.size(); ++r) {
    const double depth = rows.table.d_hat[r] - rows.table.d[r];
    energy += rows.table.multiplicity[r] * rows.table.kappa[r] * depth * depth;
  }
  return energy;
}

TEST(KappaInheritance, BIsContinuousWhereAPointSlidesOverAnEdge) {
  const Scene scene = point_over_fan();
  ContactSystem contacts(scene, {});
  Rows before = at(contacts, scene, -1e-9), after = at(contacts, scene, 1e-9);
  ASSERT_EQ(before.table.size(), 2U);  // on one triangle, and on the edge of the other
  ASSERT_EQ(after.table.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    before.table.kappa[r] = before.table.kind[r] == ContactKind::point_triangle ? 7 : 3;
  }
  KappaMemory memory;
  memory.store(before.table, before.mollified);

  std::vector<int> missing, missing_mollified;
  memory.recall(after.table, after.mollified, missing, missing_mollified);
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(after.table.kind[static_cast<std::size_t>(missing[0])], ContactKind::point_triangle);
  memory.inherit(after.table, after.mollified, missing, missing_mollified);

  EXPECT_TRUE(missing.empty());
  EXPECT_GT(barrier_energy(before), 0.01);
  EXPECT_NEAR(barrier_energy(after), barrier_energy(before), 1e-8);
}

TEST(KappaInheritance, ANewContactHasNothingToInherit) {
  Scene scene = point_over_fan();
  const int other = add_body(scene, "other", {Vec3d(0.4, 0.1, 0.05)}, {}, 0.1);
  scene.surface_vertices.push_back(other);
  ContactSystem contacts(scene, {});
  Rows rows = at(contacts, scene, -0.3);
  KappaMemory memory;
  Positions away = scene.x0;
  away.col(other) += Vec3d(0, 0, 10);
  away(0, 0) = -0.3;
  Rows alone = rows_at(contacts, away);
  ASSERT_EQ(alone.table.size(), 1U);
  alone.table.kappa[0] = 5;
  memory.store(alone.table, alone.mollified);

  std::vector<int> missing, missing_mollified;
  memory.recall(rows.table, rows.mollified, missing, missing_mollified);
  ASSERT_EQ(missing.size(), 1U);
  memory.inherit(rows.table, rows.mollified, missing, missing_mollified);
  EXPECT_EQ(missing.size(), 1U);
  EXPECT_EQ(rows.table.kappa[static_cast<std::size_t>(missing[0])], 0);
}

}  // namespace
}  // namespace bb::test
