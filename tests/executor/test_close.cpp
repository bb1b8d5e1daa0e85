// Close, thick bodies of every kind on an executor: rows, step bound, gradient and matrix are those of the CPU path.
#include "tests/contact/close_bodies.hpp"
#include "tests/executor/assembled.hpp"
#include "tests/executor/both_bounds.hpp"
#include "tests/executor/rows_pair_by_pair.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::executor_close_test {
namespace {

/// Calls f(scene, a state near its own): alone, and several of them side by side with partly prescribed bodies.
template <class F>
void for_each_scene(unsigned n_alone, unsigned n_mixed, double reach, const F& f) {
  unsigned seed = 11;
  for_each_close_scene(n_alone, 500, [&](CloseBodies bodies) {
    if (bodies.pairs.empty()) return;
    for (double& d : bodies.scene.d_hat) d *= reach;
    f(bodies.scene, approach(bodies, 0, 0.002, ++seed));
  });
  // of nearly parallel edges each set of ends is given in turn, but not all
  for (unsigned k = 1; k <= 3 * n_mixed; ++k) {
    const CloseBodies bodies = near_parallel(k, k % (k % 3 == 0 ? 3 : 15));
    f(bodies.scene, bodies.scene.x0);
  }
  for (unsigned k = 1; k <= n_mixed; ++k) {
    const Scene scene = mixed_scene(k, k % 3 == 0, reach);
    f(scene, scene.x0);
  }
}

TEST(ExecutorClose, HasTheRowsOfTheCpuPath) {
  std::array<int, 8> n_kinds{};
  int n = 0, thick = 0;
  for_each_scene(3, 20, 30, [&](const Scene& scene, const Positions& x) {
    ContactSystem contacts(scene, {});
    const Rows reference = rows_at(contacts, x);
    if (reference.table.size() + reference.mollified.size() == 0) return;
    TestedExecutor executor;
    OnExecutor on(executor, scene, x);
    compare(scene, on.rows, reference, n_kinds);
    ++n;
    for (const double offset : reference.table.offset) thick += offset > 0;
  });
  EXPECT_GT(n, 250);
  EXPECT_GT(thick, 500);
  for (const int of_kind : n_kinds) EXPECT_GT(of_kind, 5);
}

TEST(ExecutorClose, IsBoundedAsOnTheCpuPathToTheBit) {
  std::array<int, 8> n_of_kind{};
  unsigned seed = 1;
  for_each_close_scene(4, 3000, [&](const CloseBodies& bodies) {
    if (bodies.pairs.empty()) return;
    for (const double size : {1e-4, 0.02, 0.5})
      expect_that_of_the_cpu_path(bodies.scene, approach(bodies, size, 0.3 * size, ++seed), n_of_kind);
  });
  for (const ContactKind kind :
       {ContactKind::point_edge, ContactKind::point_triangle, ContactKind::edge_edge, ContactKind::obstacle,
        ContactKind::obstacle_edge, ContactKind::obstacle_triangle})
    EXPECT_GT(n_of_kind[static_cast<std::size_t>(kind)], 10) << static_cast<int>(kind);
  EXPECT_GT(n_of_kind[7], 50);
}

/// Groups of bodies with empty stretches between them along every axis, fewer and more than are folded away.
TEST(ExecutorClose, IsThatOfTheCpuPathAcrossEmptyStretches) {
  std::array<int, 8> n_of_kind{};
  std::array<int, 8> n_kinds{};
  for (const int n_groups : {1, 2, 3, 6, 8, 11}) {
    Scene scene;
    for (int g = 0; g < n_groups; ++g) {
      const double far = g == 0 ? 0 : 1e6 * std::pow(3.0, g);
      const Vec3d place(far, g % 2 ? -far : far, g % 3 ? far : 0);
      append(scene, close_bodies(Piece::edge, Piece::sheet, 0.004, 40U + unsigned(g)).scene, place);
      append(scene, close_bodies(Piece::point, Piece::strip, 0.004, 60U + unsigned(g)).scene,
             place + Vec3d(0, 40, 0));
    }
    for (double& d : scene.d_hat) d *= 10;
    for (const double size : {1e-3, 0.1})
      expect_that_of_the_cpu_path(scene, moved(scene, size, 3), n_of_kind);
    TestedExecutor executor;
    ContactSystem contacts(scene, {});
    OnExecutor on(executor, scene, scene.x0);
    compare(scene, on.rows, rows_at(contacts, scene.x0), n_kinds);
  }
  EXPECT_GT(n_kinds[1] + n_kinds[2] + n_kinds[3], 20);
  EXPECT_LT(n_of_kind[7], 12);
}

TEST(ExecutorClose, AddsUpGradientAndMatrixOfTheCpuPath) {
  int n = 0;
  std::size_t n_curved = 0, n_mollified = 0, n_forces = 0;
  for_each_scene(1, 12, 30, [&](const Scene& scene, const Positions& x) {
    const Positions motion = motion_of_given(scene);
    for (const Projection projection : {Projection::none, Projection::psd}) {
      const Reference expected = reference_of(scene, x, motion, HessianMode::projected_full, projection);
      if (!(expected.gradient.norm() > 0)) return;
      TestedExecutor executor;
      const Assembled got = assemble(executor, scene, x, motion, {HessianMode::projected_full, projection});
      EXPECT_GT(got.n_rows, 0);
      EXPECT_NEAR(got.energy, expected.energy, 1e-11 * expected.energy);
      EXPECT_LT(relative(got.gradient, expected.gradient), 1e-11);
      EXPECT_LT(relative(got.matrix, expected.projected), 1e-10);
      EXPECT_LE((got.force - expected.force).norm(), 1e-10 * expected.force.norm());
      n_curved += expected.n_curved, n_mollified += expected.n_mollified;
      n_forces += expected.force.norm() > 0;
      ++n;
    }
  });
  EXPECT_GT(n, 100);
  EXPECT_GT(n_curved, 300U);
  EXPECT_GT(n_mollified, 30U);
  EXPECT_GT(n_forces, 10U);
}

}  // namespace
}  // namespace bb::test::executor_close_test
