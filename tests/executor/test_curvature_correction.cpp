// The curvature correction for gaps that are curved along a motion, of rows on an executor against the rows of the CPU path.
#include <gtest/gtest.h>

#include "barriers/shapes/registry.hpp"
#include "core/contact/executor/curvature_correction_kernels.hpp"
#include "core/contact/executor/executor_barrier.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "tests/contact/obstacle_scenes.hpp"
#include "tests/executor/contact_on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::executor_curvature_correction_test {
namespace {

constexpr double kappa = 350;

BarrierFunction cubic() { return {require_shape("cubic"), Argument::gap}; }

Positions motion_of_free(const Scene& scene, double size) {
  Positions dx = random_motion(Positions::Zero(3, scene.n_vertices()), size, 31);
  for (const Pin& pin : scene.pins) dx.col(pin.vertex).setZero();
  return dx;
}

struct Correction {
  HoldTimes held;
  Positions force;
  std::size_t n_rows = 0;
};

Correction on_host(const Scene& scene, const Positions& x, const Positions& dx) {
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, x);
  std::fill(rows.table.kappa.begin(), rows.table.kappa.end(), kappa);
  cubic().eval(rows.table.size(), rows.table.d.data(), rows.table.d_hat.data(), rows.table.b.data(),
               rows.table.db.data(), rows.table.d2b.data());
  Correction out{{}, Positions::Zero(3, scene.n_vertices()), rows.table.size()};
  out.held = add_curvature_correction(rows.table, x, dx, out.force);
  return out;
}

Correction on_executor(exec::Executor& executor, const Scene& scene, const Positions& x,
                       const Positions& dx) {
  const int n = scene.n_vertices();
  OnExecutor on(executor, scene, x);
  on.rows.uniform_kappa = kappa;
  exec::ExecutorBarrier(cubic(), false).evaluate(executor, on.rows);
  exec::ContactAssembly assembly(executor, on.surface_there, n);
  assembly.set_pattern(on.rows);
  exec::Buffer<double> moved(executor, "motion"), force(executor, "force", 3 * n);
  upload(moved, dx);
  force.fill_zero();
  exec::ExecutorLeast curved(executor), straight(executor);
  executor.each(on.rows.size(),
                exec::CurvatureCorrectionRows{on.rows.view(), on.surface_there.view(), on.x.data(),
                                              moved.data(), curved.data(), straight.data()});
  assembly.add_gradient(on.rows, on.x, force);
  return {{curved.smallest(), straight.smallest()},
          Positions::Map(force.data(), 3, n),
          static_cast<std::size_t>(on.rows.size())};
}

TEST(ExecutorCurvatureCorrection, IsThatOfTheCpuPathInAnyOrder) {
  int n_curved = 0, n_straight = 0;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    for (const Scene& scene :
         {full_scene(seed), around_obstacles(seed), planar_layers(PlanarPairs::point_edge, seed)}) {
      const Positions x = shaken(scene);
      for (const double size : {1e-3, 0.3}) {
        const Positions dx = motion_of_free(scene, size);
        const Correction expected = on_host(scene, x, dx);
        ASSERT_GT(expected.n_rows, 5U);
        ASSERT_GT(expected.force.norm(), 0);
        n_curved += expected.held.curved > 0 && std::isfinite(expected.held.curved);
        n_straight += expected.held.straight > 0 && std::isfinite(expected.held.straight);
        std::string first;
        for (const exec::Order order : all_orders) {
          TestedExecutor executor(order, seed);
          const Correction got = on_executor(executor, scene, x, dx);
          // pairs of one row are added up one by one
          EXPECT_LT((got.force - expected.force).norm(), 1e-11 * expected.force.norm()) << size;
          EXPECT_NEAR(got.held.straight, expected.held.straight, 1e-11 * std::abs(expected.held.straight));
          if (std::isfinite(expected.held.curved)) {
            EXPECT_NEAR(got.held.curved, expected.held.curved, 1e-9 * std::abs(expected.held.curved));
          }
          EXPECT_EQ(std::isfinite(got.held.curved), std::isfinite(expected.held.curved));
          std::string bytes(reinterpret_cast<const char*>(got.force.data()),
                            static_cast<std::size_t>(got.force.size()) * sizeof(double));
          if (first.empty()) first = bytes;
          EXPECT_TRUE(bytes == first);
        }
      }
    }
  }
  EXPECT_GT(n_curved, 1);
  EXPECT_GT(n_straight, 3);
}

}  // namespace
}  // namespace bb::test::executor_curvature_correction_test
