// The primitives of a surface: which can move, which are part of nothing larger, and their means, against lists made by
// comparing everything with everything.
#include "core/contact/surface.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/contact/close_bodies.hpp"

namespace bb::test::surface_test {
namespace {

/// Triangles, edges and points at random on few vertices: fans, rods that begin or end on a sheet, lone vertices. Edges in
/// either direction, a third of all vertices given.
Scene tangle(unsigned seed, bool planar) {
  std::mt19937_64 rng(seed);
  Scene scene;
  scene.planar = planar;
  const int n = 14;
  std::vector<Vec3d> vertices;
  for (int v = 0; v < n; ++v) vertices.push_back(in_box(rng, 1, planar));
  add_body(scene, "tangle", vertices, {}, 0.01);
  const auto any = [&] { return static_cast<int>(rng() % n); };
  Triangles triangles;
  for (int t = 0; t < 3; ++t) {
    const std::array<int, 3> one{any(), any(), any()};
    if (one[0] != one[1] && one[1] != one[2] && one[2] != one[0]) triangles.push_back(one);
  }
  if (planar) {
    scene.membranes.emplace_back().triangles = triangles;
  } else {
    scene.surface_triangles = triangles;
  }
  for (int e = 0; e < 5; ++e) {
    const int a = any(), b = any();
    if (a != b) scene.surface_edges.push_back({a, b});
  }
  scene.motions.push_back({});
  for (int v = 0; v < n; ++v) {
    scene.d_hat[at(v)] = between(rng, 0.01, 0.02);
    scene.offset[at(v)] = between(rng, 0, 0.02);
    if (rng() % 3 == 0) scene.pins.push_back({v, 0});
  }
  return scene;
}

template <std::size_t N>
double mean(const std::vector<double>& column, const std::array<int, N>& vertices) {
  double sum = 0;
  for (const int v : vertices) sum += column[at(v)];
  return sum / static_cast<double>(N);
}

struct Tally {
  int lone_points = 0, covered_points = 0, lone_edges = 0, sides = 0, given = 0, filled = 0, unfilled = 0;
};

template <int N>
void expect_columns(const Scene& scene, const Primitives<N>& p, Tally& tally) {
  std::set<int> given;
  for (const Pin& pin : scene.pins) given.insert(pin.vertex);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(p.side[i].d_hat, mean(scene.d_hat, p.vertices[i]), 1e-16);
    EXPECT_NEAR(p.side[i].offset, mean(scene.offset, p.vertices[i]), 1e-16);
    const bool free = std::any_of(p.vertices[i].begin(), p.vertices[i].end(),
                                  [&given](int v) { return given.count(v) == 0; });
    EXPECT_EQ(p.free[i] != 0, free);
    tally.given += !free;
  }
}

bool holds(const std::vector<std::array<int, 2>>& edges, int v) {
  return std::any_of(edges.begin(), edges.end(), [v](const auto& e) { return e[0] == v || e[1] == v; });
}

void expect_lone(const Scene& scene, const Surface& surface, Tally& tally) {
  std::set<std::array<int, 2>> sides, all;
  for (const auto& t : scene.surface_triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      sides.insert({std::min(a, b), std::max(a, b)});
    }
  }
  all = sides;
  for (const auto& e : scene.surface_edges) all.insert({std::min(e[0], e[1]), std::max(e[0], e[1])});
  ASSERT_EQ(std::vector(all.begin(), all.end()), surface.edges.vertices);
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const bool side = sides.count(surface.edges.vertices[e]) > 0;
    EXPECT_EQ(surface.edges.lone[e] == 0, side);
    ++(side ? tally.sides : tally.lone_edges);
  }
  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    const bool covered = holds(surface.edges.vertices, surface.points.vertices[p][0]);
    EXPECT_EQ(surface.points.lone[p] == 0, covered) << surface.points.vertices[p][0];
    ++(covered ? tally.covered_points : tally.lone_points);
  }
}

void expect_filled(const Scene& scene, const Surface& surface, Tally& tally) {
  std::set<std::array<int, 3>> expected;
  for (const auto& t : scene.planar ? scene.membrane_triangles() : scene.surface_triangles) {
    const bool free = std::any_of(t.begin(), t.end(), [&](int v) { return surface.vertex_free[at(v)] != 0; });
    if (free) expected.insert(t);
    ++(free ? tally.filled : tally.unfilled);
  }
  EXPECT_EQ(std::set(surface.filled.begin(), surface.filled.end()), expected);
}

TEST(Surface, SaysWhatIsFreeAloneAndFilled) {
  Tally tally;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    const Scene scene = tangle(seed, seed % 3 == 0);
    const Surface surface(scene);
    expect_columns(scene, surface.points, tally);
    expect_columns(scene, surface.edges, tally);
    expect_columns(scene, surface.triangles, tally);
    expect_lone(scene, surface, tally);
    expect_filled(scene, surface, tally);
  }
  EXPECT_GT(tally.lone_points, 100);
  EXPECT_GT(tally.covered_points, 500);
  EXPECT_GT(tally.lone_edges, 300);
  EXPECT_GT(tally.sides, 300);
  EXPECT_GT(tally.given, 300);
  EXPECT_GT(tally.filled, 300);
  EXPECT_GT(tally.unfilled, 5);
}

}  // namespace
}  // namespace bb::test::surface_test
