// Pairs that are proven far eight at a time, in float, against their closest points in double.
#include <gtest/gtest.h>

#include "core/contact/far_test.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::test::far_test_test {
namespace {

/// Claims and what they were about, over all pairs of one kind.
struct Claims {
  int clear = 0, claimed = 0, near = 0;
};

/// Every pair of two lists, eight at a time, a last one of fewer: none that is within its contact distance is
/// claimed.
template <PairKind K>
Claims claims_of(const Surface& surface, const Positions& x, std::size_t n_first, std::size_t n_second) {
  FarTest test(surface);
  test.set_state(x);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < n_first; ++i) {
    for (std::size_t j = K == PairKind::edge_edge ? i + 1 : 0; j < n_second; ++j) {
      pairs.push_back({static_cast<int>(i), static_cast<int>(j)});
    }
  }
  Claims out;
  for (std::size_t begin = 0; begin < pairs.size(); begin += FarTest::width) {
    const std::size_t n = std::min(FarTest::width, pairs.size() - begin);
    const LaneSet far = test.far<K>(&pairs[begin], n);
    EXPECT_EQ(far >> n, 0U);
    for (std::size_t lane = 0; lane < n; ++lane) {
      const ContactPair<K> pair = contact_pair<K>(surface, pairs[begin + lane]);
      const double reach = pair.law.d_hat + pair.law.offset;
      const double d = closest_points<K, double>(gather(x, pair.vertex)).d;
      const bool claimed = (far >> lane & 1) != 0;
      if (d <= reach) {
        ++out.near;
        EXPECT_FALSE(claimed) << d - reach;
      } else if (d > 1.01 * reach) {
        ++out.clear;
        out.claimed += claimed ? 1 : 0;
      }
    }
  }
  return out;
}

Scene soups(const Vec3d& where) {
  Scene scene;
  auto [v1, t1] = soup(60, 0.2, 1);
  auto [v2, t2] = soup(60, 0.2, 2);
  for (auto* v : {&v1, &v2}) {
    for (Vec3d& p : *v) p += where;
  }
  add_body(scene, "a", v1, t1, 0.1);
  add_body(scene, "b", v2, t2, 0.3, false, 0.01);
  return scene;
}

TEST(FarTest, ClaimsNearlyAllFarPairsAndNoOther) {
  for (const Vec3d& where : {Vec3d(0, 0, 0), Vec3d(1e4, -1e4, 3)}) {
    const Scene scene = soups(where);
    const Surface s(scene);
    const Claims ee = claims_of<PairKind::edge_edge>(s, scene.x0, s.edges.size(), s.edges.size());
    const Claims pt = claims_of<PairKind::point_triangle>(s, scene.x0, s.points.size(), s.triangles.size());
    const Claims pe = claims_of<PairKind::point_edge>(s, scene.x0, s.points.size(), s.edges.size());
    const Claims pp = claims_of<PairKind::point_point>(s, scene.x0, s.points.size(), s.points.size());
    for (const Claims& c : {ee, pt, pe, pp}) {
      EXPECT_GT(c.near, 300);
      EXPECT_GT(c.clear, 1000);
      EXPECT_GT(c.claimed, 0.99 * c.clear);
    }
  }
}

/// Two edges whose distance is the contact distance to the last bits, of any size, anywhere in the scene.
TEST(FarTest, NeverClaimsMoreThanTheDistance) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d(unit(rng), unit(rng), unit(rng)); };
  int claimed = 0, asked = 0;
  for (int i = 0; i < 3000; ++i) {
    const double size = std::pow(10.0, 2 * unit(rng)), away = std::pow(10.0, 2 * unit(rng));
    const Vec3d middle = point(), shift = away * point();
    for (const double share : {0.9, 1.0, 1 + 1e-15, 1 + 1e-9}) {
      Scene scene;
      const Vec3d from = i % 2 == 0 ? middle : Vec3d(1e5 * middle);
      add_body(scene, "a", {from, Vec3d(from + size * middle)}, {}, 1);
      add_body(scene, "b", {Vec3d(from + shift), Vec3d(from + shift + size * shift)}, {}, 1);
      const bool alone = i % 3 != 0;  // else a tiny part of a large scene, coarser than float resolves it
      if (!alone) add_body(scene, "c", {Vec3d(from + 1e6 * (size + away) * point())}, {}, 1);
      scene.surface_edges = {{0, 1}, {2, 3}};
      const double d = closest_points<PairKind::edge_edge, double>(scene.x0.leftCols<4>()).d;
      if (!(d > 0)) continue;
      scene.d_hat.assign(scene.d_hat.size(), share * d);
      const Surface surface(scene);
      FarTest test(surface);
      test.set_state(scene.x0);
      const IndexPair pair{0, 1};
      const bool far = test.far<PairKind::edge_edge>(&pair, 1) != 0;
      if (share < 1) {
        if (!alone) continue;
        ++asked;
        claimed += far ? 1 : 0;
      } else {
        ASSERT_FALSE(far) << i << ", share " << share;
      }
    }
  }
  EXPECT_GT(asked, 1900);
  EXPECT_GT(claimed, 0.8 * asked);
}

/// Edges so short that the squares of their common normal have no digits in float.
TEST(FarTest, NeverClaimsMoreThanTheDistanceOfTinyEdges) {
  int asked = 0;
  for (const double edge : {1e-8, 1e-9, 1e-10, 3e-11, 1e-11, 5e-12, 1e-12, 1e-13}) {
    for (const double turn : {0.0, 0.3, 1.1}) {
      Scene scene;
      const Vec3d half(0.531, 0, 0), along(0, edge * std::cos(turn), edge * std::sin(turn));
      add_body(scene, "a", {half, Vec3d(half + along)}, {}, 1);
      add_body(scene, "b", {Vec3d(-half), Vec3d(-half + Vec3d(0, 0, edge))}, {}, 1);
      add_body(scene, "c", {Vec3d(1, 1, 1), Vec3d(-1, -1, -1)}, {}, 1);
      scene.surface_edges = {{0, 1}, {2, 3}};
      const double d = closest_points<PairKind::edge_edge, double>(scene.x0.leftCols<4>()).d;
      for (const double share : {1.0, 1.003, 1.01, 1.03}) {
        scene.d_hat.assign(scene.d_hat.size(), share * d);
        const Surface surface(scene);
        FarTest test(surface);
        test.set_state(scene.x0);
        const IndexPair pair{0, 1};
        ++asked;
        EXPECT_EQ(test.far<PairKind::edge_edge>(&pair, 1), 0U)
            << edge << ", turned by " << turn << ", " << share;
      }
    }
  }
  EXPECT_EQ(asked, 96);
}

TEST(FarTest, ClaimsNothingOfPointsThatAreOne) {
  Scene scene;
  add_body(scene, "a", {Vec3d(1, 2, 3), Vec3d(1, 2, 3)}, {}, 0.1);
  add_body(scene, "b", {Vec3d(1, 2, 3), Vec3d(1, 2, 3)}, {}, 0.1);
  scene.surface_edges = {{0, 1}, {2, 3}};
  const Surface surface(scene);
  FarTest test(surface);
  test.set_state(scene.x0);
  const IndexPair pair{0, 1};
  EXPECT_EQ(test.far<PairKind::edge_edge>(&pair, 1), 0U);
}

}  // namespace
}  // namespace bb::test::far_test_test
