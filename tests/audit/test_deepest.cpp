// The crossing whose edge reaches furthest through a triangle is named with its depth.
#include <gtest/gtest.h>

#include "core/audit/state_audit.hpp"
#include "tests/audit/small_scenes.hpp"

namespace bb::audit::deepest_test {
namespace {

TEST(Deepest, is_the_edge_that_reaches_furthest) {
  // A triangle at z = 0, and one whose corners are at the heights 0.5, 0.3 and -0.2: two of its edges cross.
  const AuditMesh mesh = two_triangles();
  Positions x(3, 6);
  x << -5, 5, 0, 0.1, 0.3, 0.2,  //
      -5, -5, 5, 0.1, 0.2, 0.4,  //
      0, 0, 0, 0.5, 0.3, -0.2;
  const StateAudit found = audit_state(mesh, x, true);
  ASSERT_EQ(found.crossings, 2);
  ASSERT_TRUE(found.deepest);
  EXPECT_NEAR(found.deepest_m, 0.2, 1e-15);
  x(2, 5) = -0.4;  // now the shorter end of the second edge is above
  const StateAudit deeper = audit_state(mesh, x, true);
  EXPECT_NEAR(deeper.deepest_m, 0.4, 1e-15);
  EXPECT_EQ(mesh.edges.col(deeper.deepest->first), Eigen::Vector2i(5, 3));
  x.row(2).tail(3).array() += 1.0;
  const StateAudit none = audit_state(mesh, x, true);
  EXPECT_EQ(none.crossings, 0);
  EXPECT_FALSE(none.deepest);
}

TEST(Deepest, of_equal_ones_is_the_lower_name_in_any_order) {
  StateAudit a, b;
  a.keep_deeper(PairName{PairKind::edge_triangle, 7, 1}, 0.5);
  b.keep_deeper(PairName{PairKind::edge_triangle, 2, 9}, 0.5);
  StateAudit ab = a, ba = b;
  ab.merge(b), ba.merge(a);
  EXPECT_EQ(ab.deepest->first, 2);
  EXPECT_EQ(ba.deepest->first, 2);
}

}  // namespace
}  // namespace bb::audit::deepest_test
