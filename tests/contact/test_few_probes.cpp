// Queries that run out of probes among pairs that block earlier or later: what is left of the bound is proven, says that probes ran
// out, and names the pair that it is of. Every pair is queried here by itself, and states up to the bound are measured in long double.
#include <gtest/gtest.h>

#include <map>

#include "core/geometry/accd.hpp"
#include "tests/contact/bound_of.hpp"
#include "tests/contact/obstacle_scenes.hpp"
#include "tests/geometry/closest_oracle.hpp"

namespace bb::test::few_probes_test {
namespace {

/// Of a time, by the order of the ends of edges.
constexpr double rounding = 1e-12;

struct Asked {
  double toi = 1;
  bool capped = false;
};

/// Of every pair of two loose triangles by its vertices, ascending: queried alone.
template <PairKind K>
void ask(const Positions& x0, const Positions& x1, const std::array<int, 4>& v, int probes, ContactKey key,
         std::map<ContactKey, Asked>& out) {
  Mat<double, 3, 4> from, to;
  for (int k = 0; k < 4; ++k) {
    from.col(k) = x0.col(v[static_cast<std::size_t>(k)]);
    to.col(k) = x1.col(v[static_cast<std::size_t>(k)]);
  }
  const AccdResult<double> found = accd<K, double>(from, to, 0.0, 1e-6 * d_hat, probes);
  Asked& kept = out[key];
  if (found.hit && found.toi < kept.toi) kept.toi = found.toi;
  kept.capped = kept.capped || found.capped;
}

std::map<ContactKey, Asked> ask_all(const Scene& scene, const Positions& x1, int probes) {
  std::map<ContactKey, Asked> out;
  const auto key_of = [](std::array<int, 4> v) {
    std::sort(v.begin(), v.end());
    return ContactKey{v[0], v[1], v[2], v[3]};
  };
  const auto& triangles = scene.surface_triangles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = 0; j < triangles.size(); ++j) {
      if (i == j) continue;
      const auto &a = triangles[i], &b = triangles[j];
      for (const int p : a) {
        const std::array<int, 4> v{p, b[0], b[1], b[2]};
        ask<PairKind::point_triangle>(scene.x0, x1, v, probes, key_of(v), out);
      }
      for (std::size_t k = 0; i < j && k < 9; ++k) {
        const std::array<int, 4> v{a[k % 3], a[(k + 1) % 3], b[k / 3], b[(k / 3 + 1) % 3]};
        ask<PairKind::edge_edge>(scene.x0, x1, v, probes, key_of(v), out);
      }
    }
  }
  return out;
}

double least(const std::map<ContactKey, Asked>& asked) {
  double out = 1;
  for (const auto& [key, one] : asked) out = std::min(out, one.toi);
  return out;
}

/// Of all vertices and triangles of different bodies at x.
double least_distance(const Scene& scene, const Positions& x) {
  double out = std::numeric_limits<double>::infinity();
  for (const auto& a : scene.surface_triangles) {
    for (const auto& b : scene.surface_triangles) {
      if (&a == &b) continue;
      for (std::size_t k = 0; k < 12; ++k) {
        Points<Long, 4> p;
        const bool vertex = k < 3;
        const std::array<int, 4> v =
            vertex ? std::array{a[k], b[0], b[1], b[2]}
                   : std::array{a[k % 3], a[(k + 1) % 3], b[(k - 3) / 3], b[((k - 3) / 3 + 1) % 3]};
        for (int i = 0; i < 4; ++i) p.col(i) = x.col(v[static_cast<std::size_t>(i)]).cast<Long>();
        out = std::min(out, static_cast<double>(enumerate_faces(p, 4, vertex ? 1 : 2).d));
      }
    }
  }
  return out;
}

TEST(FewProbes, LeaveABoundThatIsProvenAndSaysSo) {
  int capped_first = 0, capped_later = 0, blocked = 0;
  for (unsigned seed = 0; seed < 90; ++seed) {
    Scene scene;
    const auto [vertices, triangles] = soup(5, 0.25, seed);
    add_body(scene, "loose", vertices, triangles, d_hat);
    if (!(least_distance(scene, scene.x0) > 2 * d_hat)) continue;
    const Positions x1 = random_motion(scene.x0, 1.5, seed + 1000);
    const double whole = least(ask_all(scene, x1, 4096));
    for (const int probes : {1, 2, 3, 5, 4096}) {
      ContactOptions options;
      options.ccd_max_probes = probes;
      ContactSystem contacts(scene, options);
      contacts.update_candidates(scene.x0, x1);
      const StepBound found = contacts.step_bound(scene.x0, x1);
      const std::map<ContactKey, Asked> asked = ask_all(scene, x1, probes);
      EXPECT_LE(found.alpha, whole + rounding) << seed << " " << probes;
      EXPECT_GE(found.alpha, least(asked) - rounding) << seed << " " << probes;
      if (found.alpha < 1) {
        EXPECT_NEAR(asked.at(found.key).toi, found.alpha, rounding) << seed << " " << probes;
        EXPECT_GT(found.alpha, 0) << seed;
        ++blocked;
      }
      EXPECT_TRUE(found.capped > 0 || std::abs(found.alpha - whole) <= rounding) << seed << " " << probes;
      for (const double share : {0.25, 0.5, 0.75, 1.0}) {
        const Positions x = scene.x0 + share * found.alpha * (x1 - scene.x0);
        EXPECT_GT(least_distance(scene, x), 0) << seed << " " << probes << " " << share;
      }
      if (found.alpha < 1 && found.capped > 0) ++(asked.at(found.key).capped ? capped_first : capped_later);
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(blocked, 60);
  EXPECT_GT(capped_first, 20) << "no bound is that of a query that ran out";
  EXPECT_GT(capped_later, 3) << "no query runs out while another pair blocks";
}

/// At a ball and at a bar, whose queries of edges and triangles have probes too.
TEST(FewProbes, AtAnObstacleTheBoundIsProvenAndSaysSo) {
  int short_of = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    Scene scene = around_obstacles(2 * seed);
    scene.pins.clear();
    const Positions x1 = random_motion(scene.x0, 0.4, seed + 7);
    double whole = 0;
    for (const int probes : {4096, 3, 2, 1}) {
      ContactOptions options;
      options.ccd_max_probes = probes;
      ContactSystem contacts(scene, options);
      contacts.update_candidates(scene.x0, x1);
      const StepBound found = contacts.step_bound(scene.x0, x1);
      if (probes == 4096) whole = found.alpha;
      EXPECT_LE(found.alpha, whole) << seed << " " << probes;
      EXPECT_TRUE(found.capped > 0 || found.alpha == whole) << seed << " " << probes;
      short_of += found.alpha < whole;
      for (const double share : {0.5, 1.0}) {
        const Positions x = scene.x0 + share * found.alpha * (x1 - scene.x0);
        EXPECT_GT(least_gap(scene, x), 0) << seed << " " << probes << " " << share;
      }
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(short_of, 10);
}

}  // namespace
}  // namespace bb::test::few_probes_test
