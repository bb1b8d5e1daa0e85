// kappa of the policy elasticity_inclusive in whole scenes that are small enough to be worked out by hand: springs between the vertices of
// a contact and beside it. The elastic part is the second derivative of the energy of the springs along w, the weighted normals of
// the free vertices, in long double; nothing of the code under test is used for it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::kappa_by_hand_test {
namespace {

using Long = long double;

constexpr double d_hat = 0.01, gap = 0.004, h = 0.02;

/// One contact, whose normal is z, and the weights of its vertices, which are the first of the scene.
struct Contact {
  std::string name;
  Scene scene;
  std::vector<Long> weight;
};

/// Adds a body of one primitive with its edges.
void add(Scene& scene, const std::vector<Vec3d>& x) {
  const test::Triangles faces = x.size() == 3 ? test::Triangles{{0, 1, 2}} : test::Triangles{};
  const int v = test::add_body(scene, "body" + std::to_string(scene.bodies.size()), x, faces, d_hat);
  if (x.size() == 2) scene.surface_edges.push_back({v, v + 1});
  if (x.size() == 3)
    scene.surface_edges.insert(scene.surface_edges.end(), {{v, v + 1}, {v + 1, v + 2}, {v, v + 2}});
}

/// Every kind of contact, at the gap, with closest points at thirds, quarters and halves.
std::vector<Contact> contacts() {
  const Vec3d point(0, 0, gap);
  std::vector<Contact> out(5);
  out[0].name = "a point and a triangle", out[0].weight = {1, -0.5L, -0.25L, -0.25L};
  add(out[0].scene, {point});
  add(out[0].scene, {Vec3d(0, -1, 0), Vec3d(-1, 1, 0), Vec3d(1, 1, 0)});
  out[1].name = "two edges", out[1].weight = {0.75L, 0.25L, -0.5L, -0.5L};
  add(out[1].scene, {Vec3d(-1, 0, gap), Vec3d(3, 0, gap)});
  add(out[1].scene, {Vec3d(0, -1, 0), Vec3d(0, 1, 0)});
  out[2].name = "a point and an edge", out[2].weight = {1, -0.75L, -0.25L};
  add(out[2].scene, {point});
  add(out[2].scene, {Vec3d(-1, 0, 0), Vec3d(3, 0, 0)});
  out[3].name = "a point and the end of an edge", out[3].weight = {1, -1};
  add(out[3].scene, {point});
  add(out[3].scene, {Vec3d(0, 0, 0), Vec3d(0.5, 0, -1)});
  out[4].name = "a point and the floor", out[4].weight = {1};
  add(out[4].scene, {point});
  Obstacle floor;
  floor.name = "floor";
  out[4].scene.obstacles = {floor};
  return out;
}

/// Springs between all vertices of the contact, and from each to a vertex of its own that is far away, obliquely. All have the same
/// ratio of their length at rest and now.
void add_springs(Scene& scene, int n, double ratio) {
  std::vector<Vec3d> far;
  for (int v = 0; v < n; ++v) far.push_back(scene.x0.col(v) + Vec3d(3 + v, 1 - v, (v % 2 ? -4 : 4) - v));
  const int first = scene.n_vertices();
  for (const Vec3d& x : far) add(scene, {x});
  for (int i = 0; i < n; ++i) {
    scene.springs.edges.push_back({i, first + i});
    for (int j = i + 1; j < n; ++j) scene.springs.edges.push_back({i, j});
  }
  for (std::size_t e = 0; e < scene.springs.edges.size(); ++e)
    scene.springs.stiffness.push_back(500 + 40 * static_cast<double>(e));
  scene.rest = ratio * scene.x0;
  for (std::size_t v = 0; v < scene.mass.size(); ++v) scene.mass[v] = 0.1 * (1 + static_cast<double>(v));
}

void hold(Scene& scene, int v) {
  scene.motions.resize(1);
  scene.pins = {{v, 0}};
  scene.mass[static_cast<std::size_t>(v)] = 0;
}

/// w^T w, w^T M w and w^T H w.
struct Sums {
  Long w_sq = 0, mass = 0, elastic = 0;
};

/// A spring of length l and rest length r l is in the direction s: its energy has the second derivative
/// k ((s . u)^2 + (1 - r) (u^2 - (s . u)^2)) where its ends go apart by u, of which only what is not negative counts.
Sums by_hand(const Scene& scene, std::vector<Long> w, Long ratio) {
  for (const Pin& pin : scene.pins) w[static_cast<std::size_t>(pin.vertex)] = 0;
  w.resize(static_cast<std::size_t>(scene.n_vertices()), 0);
  Sums out;
  for (std::size_t v = 0; v < w.size(); ++v) {
    out.w_sq += w[v] * w[v];
    out.mass += w[v] * w[v] * static_cast<Long>(scene.mass[v]);
  }
  for (std::size_t e = 0; e < scene.springs.edges.size(); ++e) {
    const auto [i, j] = scene.springs.edges[e];
    const Eigen::Matrix<Long, 3, 1> way = (scene.x0.col(j) - scene.x0.col(i)).cast<Long>();
    const Long apart = w[static_cast<std::size_t>(j)] - w[static_cast<std::size_t>(i)];  // along z
    const Long along = way[2] * way[2] / way.squaredNorm();
    const Long across = std::max<Long>(0, 1 - ratio) * (1 - along);
    out.elastic += static_cast<Long>(scene.springs.stiffness[e]) * apart * apart * (along + across);
  }
  return out;
}

/// kappa of the only contact at the start of a step.
double kappa_of(const Scene& scene, const PolicyConfig& policy, double c) {
  Method method = test::fixed_method("cubic", 1, c == 1 ? "implicit_euler" : "newmark");
  method.stiffness = make_policy(policy);
  NewtonSystem system(scene, method);
  system.begin_step(scene.x0, {c, scene.x0, h}, h, 1);
  system.assemble();
  const ContactTable& rows = test::rows_of(system).rows;
  EXPECT_EQ(rows.size(), 1U);
  EXPECT_NEAR(rows.d.at(0), gap, 1e-15);
  return rows.kappa.at(0);
}

PolicyConfig policy_of(const std::string& mass_term, const std::string& refresh = "per_iteration") {
  PolicyConfig out;
  out.name = "elasticity_inclusive";
  out.parameters.emplace("mass_term", mass_term);
  out.parameters.emplace("refresh", refresh);
  return out;
}

TEST(KappaByHand, IsThatOfItsFormulaForEveryKindOfContact) {
  int judged = 0;
  for (const double ratio : {0.8, 1.0, 1.25}) {  // stretched, at rest, compressed
    for (Contact& one : contacts()) {
      const int n = static_cast<int>(one.weight.size());
      add_springs(one.scene, n, ratio);
      for (const bool held : {false, true}) {
        if (held && n == 1) continue;
        if (held) hold(one.scene, n - 1);
        SCOPED_TRACE(one.name + (held ? ", its last vertex held" : ""));
        const Sums sums = by_hand(one.scene, one.weight, static_cast<Long>(ratio));
        ASSERT_GT(sums.elastic, 100);
        for (const double c : {1.0, 0.25}) {
          const Long inertia = sums.mass / (static_cast<Long>(c) * h * h);
          const Long widths = static_cast<Long>(d_hat) / gap;
          const std::pair<const char*, Long> terms[] = {{"paper", sums.mass / (static_cast<Long>(gap) * gap)},
                                                        {"inertia", inertia},
                                                        {"scaled", inertia * widths * widths},
                                                        {"none", 0}};
          for (const auto& [name, mass] : terms) {
            for (const char* refresh : {"per_iteration", "per_step"}) {
              const double expected = static_cast<double>((mass + sums.elastic) / sums.w_sq);
              EXPECT_NEAR(kappa_of(one.scene, policy_of(name, refresh), c), expected, 1e-11 * expected)
                  << name;
              ++judged;
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(judged, 3 * 9 * 16);
}

/// A point over an edge, weights 1, -3/4, -1/4: w^T w = 13/8. The edge is a spring of 40 N/m, 4 m long where 3.2 m is its rest:
/// 40 (1 - 0.8) (3/4 - 1/4)^2 = 2 N/m. The point hangs on a spring of 500 N/m in the direction (3, 0, 4)/5, stretched as much:
/// 500 (0.64 + 0.2 0.36) = 356 N/m. Masses of 0.4, 0.16 and 1.6 kg: w^T M w = 0.4 + 0.09 + 0.1 = 0.59 kg, over (4 mm)^2 36875 N/m.
TEST(KappaByHand, IsANumberThatOneCanWriteDown) {
  Contact one = contacts()[2];
  add(one.scene, {Vec3d(3, 0, gap + 4)});
  one.scene.springs.edges = {{1, 2}, {0, 3}};
  one.scene.springs.stiffness = {40, 500};
  one.scene.rest = 0.8 * one.scene.x0;
  one.scene.mass = {0.4, 0.16, 1.6, 1};
  EXPECT_NEAR(kappa_of(one.scene, policy_of("paper"), 1), (36875 + 358) / 1.625, 1e-6);
  EXPECT_NEAR(kappa_of(one.scene, policy_of("none"), 1), 358 / 1.625, 1e-9);
}

}  // namespace
}  // namespace bb::kappa_by_hand_test
