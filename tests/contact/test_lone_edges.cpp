// Rods: edges that are no side of a triangle. Nearly parallel ones have no edge-edge force, so that their vertices
// pair with edges; here: which pairs there are, and that the barrier resists, is continuous and has its gradient.
#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/candidates.hpp"
#include "core/contact/pair_geometry.hpp"
#include "tests/contact/rods.hpp"

namespace bb::test::lone_edges_test {
namespace {

constexpr double reach = 0.01;

Candidates candidates_of(const Scene& scene) {
  const Surface surface(scene);
  BroadPhase broad_phase(surface, {}, plan_contact(scene));
  Candidates out;
  broad_phase.update(scene.x0, scene.x0, out);
  return out;
}

/// How strongly the upper body (its first vertex is `first`) is pushed up, by central differences, J/m.
double push_up(const Scene& scene, int first) {
  ContactSystem contacts(scene, {});
  const auto energy = [&](double z) {
    Positions x = scene.x0;
    x.row(2).rightCols(x.cols() - first).array() += z;
    return barrier(contacts, x, 1.0, TestShape::cubic);
  };
  constexpr double h = 1e-7;
  return (energy(-h) - energy(h)) / (2 * h);
}

/// Two straight rods of random length, shift, direction and number of segments, `gap` apart in z beyond their thickness.
Scene random_rods(std::mt19937_64& rng, double angle, double gap, int* first) {
  std::uniform_real_distribution<double> unit(0, 1);
  Scene scene;
  const double turn = 3 * unit(rng), offset = unit(rng) < 0.5 ? 0 : 0.002;
  const auto direction = [](double a) { return Vec3d(std::cos(a), std::sin(a), 0); };
  add_rod(scene, Vec3d(0, 0, 0), (0.2 + unit(rng)) * direction(turn), 1 + static_cast<int>(3 * unit(rng)),
          reach, offset);
  const double part = 0.9 * unit(rng) * scene.rest.col(scene.n_vertices() - 1).norm();
  *first = add_rod(scene, part * direction(turn) + Vec3d(0, 0, gap + 2 * offset),
                   (0.1 + unit(rng)) * direction(turn + angle), 1 + static_cast<int>(3 * unit(rng)), reach,
                   offset);
  return scene;
}

TEST(LoneEdges, PushEachOtherApartAtEveryAngle) {
  std::mt19937_64 rng(1);
  for (const double angle : {0.0, 1e-12, 1e-6, 1e-3, 0.02, 0.0316, 0.04, 0.3, 1.5}) {
    for (int trial = 0; trial < 20; ++trial) {
      int first = 0;
      const Scene scene = random_rods(rng, angle, 0.4 * reach, &first);
      // at least what one pair with this gap pushes
      const double one = 3 * std::pow(0.6 * reach, 2) / reach;
      EXPECT_GT(push_up(scene, first), 0.99 * one) << angle << ", trial " << trial;
    }
  }
}

TEST(LoneEdges, EnergyIsContinuousWhereTheMollifierEnds) {
  std::mt19937_64 rng(2);
  const double threshold = std::asin(std::sqrt(1e-3));
  double most = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const std::mt19937_64 state = rng;
    double energy[2];
    for (int side = 0; side < 2; ++side) {
      rng = state;
      int first = 0;
      // the rest shapes are at a right angle there; turned into place
      Scene scene = random_rods(rng, threshold + (side ? 1e-9 : -1e-9), 0.4 * reach, &first);
      ContactSystem contacts(scene, {});
      energy[side] = barrier(contacts, scene.x0, 1.0, TestShape::cubic);
      most = std::max(most, energy[side]);
    }
    EXPECT_NEAR(energy[0], energy[1], 1e-6 * energy[1]);
  }
  EXPECT_GT(most, 1e-6);
}

TEST(LoneEdges, GradientIsThatOfTheEnergy) {
  std::mt19937_64 rng(3);
  int mollified = 0, point_edge = 0;
  for (const double angle : {1e-3, 0.02, 0.2}) {
    for (int trial = 0; trial < 10; ++trial) {
      int first = 0;
      const Scene scene = random_rods(rng, angle, 0.5 * reach, &first);
      const Positions x = random_motion(scene.x0, 1e-4, 7 + static_cast<unsigned>(trial));
      ContactSystem contacts(scene, {});
      Rows rows = rows_at(contacts, x);
      evaluate(rows.table, 1.0, TestShape::cubic);
      evaluate(rows.mollified, 1.0, TestShape::cubic);
      mollified += static_cast<int>(rows.mollified.size());
      for (const ContactKind kind : rows.table.kind) point_edge += kind == ContactKind::point_edge;
      std::vector<double> grad, hess;
      VecXd all = VecXd::Zero(x.size());
      contact_terms(rows.table, x, HessianMode::gauss_newton, Projection::none, grad, hess);
      for (std::size_t r = 0; r < rows.table.size(); ++r) {
        for (int k = 0; k < rows.table.n_free[r]; ++k)
          all.segment<3>(3 * rows.table.vertex[4 * r + at(k)]) += Vec3d::Map(&grad[12 * r + 3 * at(k)]);
      }
      mollified_terms(rows.mollified, x, Projection::none, grad, hess);
      for (std::size_t r = 0; r < rows.mollified.size(); ++r) {
        for (int k = 0; k < 4; ++k)
          all.segment<3>(3 * rows.mollified.stencil[4 * r + at(k)]) += Vec3d::Map(&grad[12 * r + 3 * at(k)]);
      }
      VecXd numeric(x.size());
      for (Eigen::Index i = 0; i < x.size(); ++i) {
        constexpr double h = 1e-7;
        Positions up = x, down = x;
        up.data()[i] += h;
        down.data()[i] -= h;
        numeric[i] =
            (barrier(contacts, up, 1.0, TestShape::cubic) - barrier(contacts, down, 1.0, TestShape::cubic)) /
            (2 * h);
      }
      ASSERT_GT(all.norm(), 1e-3);
      EXPECT_LT((numeric - all).norm(), 1e-5 * all.norm()) << angle << ", trial " << trial;
    }
  }
  EXPECT_GT(mollified, 10);
  EXPECT_GT(point_edge, 10);
}

/// Rods among themselves, a rod beside the boundary of a sheet, loose points: every close pair of a vertex and a lone
/// edge, and no other of that kind.
TEST(LoneEdges, PairWithEveryVertexThatIsNotTheirOwn) {
  std::size_t n = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene = rods_and_sheet(seed, 0.05);
    const Surface s(scene);
    ASSERT_EQ(s.lone_edges.size(), scene.surface_edges.size());
    const Candidates c = candidates_of(scene);
    EXPECT_TRUE(std::is_sorted(c.point_edge.begin(), c.point_edge.end()));
    for (const IndexPair& p : c.point_edge) {
      EXPECT_TRUE(std::binary_search(s.lone_edges.begin(), s.lone_edges.end(), p.second));
      EXPECT_TRUE(Surface::disjoint(s.points.vertices[at(p.first)][0], s.edges.vertices[at(p.second)]));
    }
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      for (const int e : s.lone_edges) {
        const IndexPair index{static_cast<int>(i), e};
        const ContactPair<PairKind::point_edge> pair = contact_pair<PairKind::point_edge>(s, index);
        if (!Surface::disjoint(pair.vertex[0], s.edges.vertices[at(e)])) continue;
        if (!s.points.free[i] && !s.edges.free[at(e)]) continue;
        const auto closest = closest_points<PairKind::point_edge, double>(gather(scene.x0, pair.vertex));
        if (closest.d > pair.law.d_hat + pair.law.offset) continue;
        ++n;
        EXPECT_TRUE(std::binary_search(c.point_edge.begin(), c.point_edge.end(), index));
      }
    }
  }
  EXPECT_GT(n, 200U);
}

TEST(LoneEdges, OfScenesThatHaveNoneMakeNoPairs) {
  Scene scene;
  const auto [vertices, triangles] = grid(4, 4, 0.1);
  add_body(scene, "sheet", vertices, triangles, 0.05);
  scene.surface_edges = {{1, 0}, {0, 6}};  // sides of a triangle, named once more
  EXPECT_FALSE(plan_contact(scene).point_edge);
  EXPECT_TRUE(Surface(scene).lone_edges.empty());
  EXPECT_TRUE(candidates_of(scene).point_edge.empty());
  scene.surface_edges.push_back({0, 24});
  EXPECT_TRUE(plan_contact(scene).point_edge);
  EXPECT_EQ(Surface(scene).lone_edges.size(), 1U);
  EXPECT_FALSE(candidates_of(scene).point_edge.empty());
}

}  // namespace
}  // namespace bb::test::lone_edges_test
