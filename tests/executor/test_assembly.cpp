// Gradient, matrix, energy and given motion of rows on an executor against the terms of the CPU path.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/contact/obstacle_scenes.hpp"
#include "tests/executor/assembled.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::executor_assembly_test {
namespace {

struct Subject {
  Scene scene;
  Positions x;
};
std::vector<Subject> subjects() {
  std::vector<Subject> out;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Scene scene = full_scene(seed);
    out.push_back({scene, shaken(scene)});
  }
  // sides along a bar, some of them with a given end
  const Scene scene = around_obstacles(2);
  out.push_back({scene, scene.x0});
  for (const PlanarPairs pairs : {PlanarPairs::vertex_vertex, PlanarPairs::point_edge}) {
    const Scene layers = planar_layers(pairs, 4);
    out.push_back({layers, layers.x0});
  }
  return out;
}

TEST(ExecutorAssembly, AddsUpWhatTheCpuPathDoes) {
  std::size_t n_mollified = 0, n_curved = 0;
  int n_forces = 0;
  double worst[3] = {0, 0, 0};
  for (const Subject& s : subjects()) {
    const Positions motion = motion_of_given(s.scene);
    for (const HessianMode mode : {HessianMode::gauss_newton, HessianMode::projected_full}) {
      for (const Projection projection : {Projection::none, Projection::psd, Projection::absolute}) {
        const Reference expected = reference_of(s.scene, s.x, motion, mode, projection);
        n_mollified += expected.n_mollified, n_curved += expected.n_curved;
        TestedExecutor executor;
        const Assembled got = assemble(executor, s.scene, s.x, motion, {mode, projection});
        ASSERT_GE(got.n_rows, 40);
        EXPECT_GT(expected.energy, 0);
        EXPECT_NEAR(got.energy, expected.energy, 1e-12 * expected.energy);
        EXPECT_LT(relative(got.gradient, expected.gradient), 1e-12);
        EXPECT_LT(relative(got.matrix, expected.projected), 1e-11);
        EXPECT_EQ((got.matrix - got.matrix.transpose()).norm() > 1e-12 * got.matrix.norm(), false);
        EXPECT_LT(relative(got.force, expected.force), 1e-11);
        worst[0] = std::max(worst[0], relative(got.gradient, expected.gradient));
        worst[1] = std::max(worst[1], relative(got.matrix, expected.projected));
        worst[2] = std::max(worst[2], relative(got.force, expected.force));
        n_forces += expected.force.norm() > 0;

        const HessianChoice blended{mode, Projection::none, true, 0.3};
        const Reference psd = reference_of(s.scene, s.x, motion, mode, Projection::psd);
        const Matrix between = psd.exact + 0.3 * (psd.projected - psd.exact);
        EXPECT_LT(relative(assemble(executor, s.scene, s.x, motion, blended).matrix, between), 1e-11);
      }
    }
  }
  for (const int i : {0, 1, 2})
    RecordProperty("worst" + std::to_string(i), std::to_string(worst[i] * 1e16) + "e-16");
  EXPECT_GT(n_mollified, 100U);
  EXPECT_GT(n_curved, 500U);
  EXPECT_GE(n_forces, 24);
}

/// To the bit; to rounding where there is a mollifier e: the host has (kappa e) b, an executor e (kappa b).
TEST(ExecutorAssembly, HasTheEnergiesOfTheHostRowByRow) {
  std::size_t n_mollified = 0, n_loaded = 0;
  for (const Subject& s : subjects()) {
    ContactSystem contacts(s.scene, {});
    Rows rows = rows_at(contacts, s.x);
    evaluate_cubic(rows.table);
    evaluate_cubic(rows.mollified);
    std::map<PairId, double> expected;
    std::vector<double> energy;
    contact_energies(rows.table, energy);
    for (std::size_t r = 0; r < energy.size(); ++r) expected[rows.table.pair[r]] = energy[r];
    mollified_energies(rows.mollified, s.x, energy);
    for (std::size_t r = 0; r < energy.size(); ++r) expected[rows.mollified.pair[r]] = energy[r];
    TestedExecutor executor;
    OnExecutor on(executor, s.scene, s.x);
    on.rows.uniform_kappa = kappa;
    ExecutorBarrier(cubic(), false).evaluate(executor, on.rows);
    ContactAssembly assembly(executor, on.surface_there, s.scene.n_vertices());
    assembly.set_pattern(on.rows);
    const exec::RowEnergy found = assembly.row_energy(on.rows, on.x);
    ASSERT_EQ(static_cast<std::size_t>(on.rows.size()), expected.size());
    for (Index r = 0; r < on.rows.size(); ++r) {
      exec::Compensated of_row = exec::Compensated::zero();
      found(r, of_row);
      const double of_host = expected.at(found.rows.pair[r]);
      const double rounding =
          found.rows.mollified(r) ? 4 * std::numeric_limits<double>::epsilon() * of_host : 0;
      EXPECT_NEAR(of_row.value(), of_host, rounding);
      n_loaded += of_row.value() > 0;
    }
    n_mollified += rows.mollified.size();
  }
  EXPECT_GT(n_mollified, 10U);
  EXPECT_GT(n_loaded, 300U);
}

TEST(ExecutorAssembly, ClampsTheRowsAtVerticesWithALargeForce) {
  std::size_t n_clamped = 0;
  for (const Subject& s : subjects()) {
    std::vector<double> force(static_cast<std::size_t>(s.scene.n_vertices()));
    for (std::size_t v = 0; v < force.size(); ++v) force[v] = v % 7 == 3 ? 2 : 1;
    for (const HessianMode mode : {HessianMode::gauss_newton, HessianMode::projected_full}) {
      std::size_t clamped = 0;
      const Matrix expected = partly_clamped(s.scene, s.x, mode, force, 2, clamped);
      n_clamped += clamped;
      TestedExecutor executor;
      exec::Buffer<double> there(executor, "forces");
      there.upload(force);
      const HessianChoice choice{mode, Projection::none, false, 1, 2, there.data()};
      const Assembled got = assemble(executor, s.scene, s.x, motion_of_given(s.scene), choice);
      ASSERT_GT(static_cast<std::size_t>(got.n_rows), clamped);
      EXPECT_LT(relative(got.matrix, expected), 1e-11);
      if (mode == HessianMode::gauss_newton) continue;
      const Reference plain = reference_of(s.scene, s.x, motion_of_given(s.scene), mode, Projection::psd);
      EXPECT_GT(relative(expected, plain.exact), 1e-6);
      EXPECT_GT(relative(expected, plain.projected), 1e-6);
    }
  }
  EXPECT_GT(n_clamped, 50U);
}

TEST(ExecutorAssembly, DoesNotDependOnTheOrderOfItems) {
  const Subject s = subjects().front();
  for (const HessianMode mode : {HessianMode::gauss_newton, HessianMode::projected_full}) {
    std::string reference;
    unsigned seed = 1;
    for (const exec::Order order : all_orders) {
      TestedExecutor executor(order, seed++);
      const Assembled got =
          assemble(executor, s.scene, s.x, motion_of_given(s.scene), {mode, Projection::psd});
      EXPECT_GT(got.matrix.norm(), 0);
      if (reference.empty()) reference = got.bytes;
      EXPECT_TRUE(got.bytes == reference);
    }
  }
}

TEST(ExecutorAssembly, DoesNotDependOnItsChunks) {
  const Subject s = subjects().front();
  for (const HessianMode mode : {HessianMode::gauss_newton, HessianMode::projected_full}) {
    std::string reference;
    for (const AssemblyOptions& options :
         {AssemblyOptions{}, AssemblyOptions{1, 1}, AssemblyOptions{64, 7}, AssemblyOptions{1000, 100}}) {
      TestedExecutor executor;
      const Assembled got =
          assemble(executor, s.scene, s.x, motion_of_given(s.scene), {mode, Projection::psd}, options);
      ASSERT_GT(got.n_blocks, 300);
      if (reference.empty()) reference = got.bytes;
      EXPECT_TRUE(got.bytes == reference) << options.pairs_a_chunk;
    }
  }
}

TEST(ExecutorAssembly, HoldsTheDiagonalOfEveryTouchedVertexAndBothTriangles) {
  const Subject s = subjects().front();
  TestedExecutor executor(exec::Order::shuffled);
  OnExecutor on(executor, s.scene, s.x);
  ContactAssembly assembly(executor, on.surface_there, s.scene.n_vertices());
  assembly.set_pattern(on.rows);
  const exec::BlockSources blocks = assembly.pattern().blocks();
  std::set<std::pair<int, int>> expected, got;
  const exec::RowView v = on.rows.view();
  Index n_upper = 0;
  for (Index r = 0; r < v.n; ++r) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        if (!v.is_free(r, a) || !v.is_free(r, b)) continue;
        expected.emplace(v.vertex[a * v.n + r], v.vertex[b * v.n + r]);
        n_upper += v.vertex[a * v.n + r] <= v.vertex[b * v.n + r];
      }
    }
  }
  for (int i = 0; i < s.scene.n_vertices(); ++i) {
    for (Index j = blocks.row_begin[i]; j < blocks.row_begin[i + 1]; ++j) {
      got.emplace(i, blocks.column[j]);
      const Index sources = blocks.begin[j + 1] - blocks.begin[j];
      EXPECT_EQ(sources > 0, blocks.column[j] >= i);
      for (Index k = blocks.begin[j] + 1; k < blocks.begin[j + 1]; ++k)
        EXPECT_LT(blocks.code[k - 1], blocks.code[k]);
    }
  }
  EXPECT_GT(got.size(), 400U);
  EXPECT_EQ(got, expected);
  EXPECT_EQ(static_cast<std::size_t>(assembly.n_blocks()), expected.size());
  EXPECT_EQ(blocks.begin[assembly.n_blocks()], n_upper);
}

TEST(ExecutorAssembly, OfNoRowsIsNothing) {
  Scene scene = full_scene(1);
  Positions far = scene.x0;
  for (int v = 0; v < scene.n_vertices(); ++v) far.col(v) += 100.0 * v * Vec3d(1, 1, 1);
  scene.obstacles.clear();
  TestedExecutor executor;
  const Assembled got = assemble(executor, scene, far, motion_of_given(scene), {});
  EXPECT_EQ(got.n_rows, 0);
  EXPECT_EQ(got.n_blocks, 0);
  EXPECT_EQ(got.gradient.norm() + got.matrix.norm() + got.energy, 0);
}

TEST(ExecutorAssembly, RefusesAProjectionWithoutAKernel) {
  const Subject s = subjects().front();
  TestedExecutor executor;
  for (const HessianMode mode :
       {HessianMode::projected_numeric, HessianMode::projected_lapack, HessianMode::projected_low_rank}) {
    EXPECT_THROW(assemble(executor, s.scene, s.x, motion_of_given(s.scene), {mode}), std::invalid_argument);
  }
}

TEST(RowSums, AreExactToRoundingAndTheSameInAnyOrder) {
  constexpr Index n = 3 * 70001;
  std::vector<double> a(n), b(n);
  std::vector<std::uint8_t> fixed(n / 3);
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  long double expected = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i % 3 == 0) fixed[i / 3] = static_cast<std::uint8_t>(rng() % 8);
    a[i] = unit(rng) * (i % 2 == 0 ? 1e8 : 1);
    b[i] = unit(rng);
    if ((fixed[i / 3] >> i % 3 & 1) == 0) expected += static_cast<long double>(a[i] * b[i]);
  }
  double first = 0;
  for (const exec::Order order : all_orders) {
    TestedExecutor executor(order);
    exec::Buffer<double> x(executor, "a"), y(executor, "b");
    exec::Buffer<std::uint8_t> mask(executor, "fixed");
    x.upload(a), y.upload(b), mask.upload(fixed);
    const double got = RowSums(executor).product(x, y, mask);
    EXPECT_NEAR(got, static_cast<double>(expected), 1e-15 * std::abs(static_cast<double>(expected)) + 1e-9);
    if (first == 0) first = got;
    EXPECT_EQ(got, first);
  }
}

TEST(RowSums, GiveTheMeanMassOfTheRows) {
  const Scene scene = full_scene(2);
  TestedExecutor executor;
  OnExecutor on(executor, scene, scene.x0);
  double mass = 0;
  int count = 0;
  const exec::RowView v = on.rows.view();
  for (Index r = 0; r < v.n; ++r) {
    for (int k = 0; k < 4; ++k) {
      if (!v.is_free(r, k)) continue;
      mass += scene.mass[at(v.vertex[k * v.n + r])];
      ++count;
    }
  }
  ASSERT_GT(count, 500);
  exec::Buffer<double> masses(executor, "masses");
  masses.upload(scene.mass);
  EXPECT_NEAR(RowSums(executor).mean_mass(on.rows, masses), mass / count, 1e-14);
}

}  // namespace
}  // namespace bb::test::executor_assembly_test
