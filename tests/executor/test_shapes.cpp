// Barrier shapes as kernels against the batch calls of the registry.
#include <gtest/gtest.h>

#include "barriers/shapes/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "core/contact/executor/executor_barrier.hpp"
#include "core/exec/host_executor.hpp"
#include "core/math/error.hpp"
#include "tests/executor/contact_on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::executor_shapes_test {
namespace {

using exec::ExecutorBarrier;
using exec::ExecutorRows;
using exec::KappaColumns;
using exec::RowView;

constexpr Index n_gaps = 400;

/// Rows with gaps from deep inside to beyond d_hat, and a kappa each.
void fill(ExecutorRows& rows) {
  rows.resize(n_gaps);
  const RowView v = rows.view();
  for (Index r = 0; r < n_gaps; ++r) {
    v.d_hat[r] = 0.01 * static_cast<double>(1 + r % 3);
    v.d[r] = v.d_hat[r] * std::pow(10.0, -6 + 6.2 * static_cast<double>(r) / n_gaps);
    v.kappa[r] = 100.0 + static_cast<double>(r);
    if (v.per_gap_sq) v.per_gap_sq[r] = 1e-3 * static_cast<double>(1 + r % 5);
  }
}

double relative(double a, double b) { return a == b ? 0 : std::abs(a - b) / std::abs(b); }

TEST(ExecutorBarrier, EvaluatesEveryShapeOfTheRegistry) {
  int n_shapes = 0;
  for (const Shape& shape : all_shapes()) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      TestedExecutor executor(exec::Order::shuffled);
      ExecutorRows rows(executor, KappaColumns::kept);
      fill(rows);
      const BarrierFunction barrier{shape, argument};
      ExecutorBarrier(barrier, false).evaluate(executor, rows);
      const RowView v = rows.view();
      double worst = 0;
      int n_active = 0;
      for (Index r = 0; r < n_gaps; ++r) {
        const ShapeTerms<double> one = barrier.eval(v.d[r], v.d_hat[r]);
        worst = std::max({worst, relative(v.energy[r], v.kappa[r] * one.b),
                          relative(v.force[r], v.kappa[r] * one.db),
                          relative(v.stiffness[r], v.kappa[r] * one.d2b)});
        n_active += one.db < 0;
      }
      EXPECT_LE(worst, 1e-13) << shape.name;
      EXPECT_GT(n_active, 300) << shape.name;
      if (shape.name == "cubic" || shape.name == "quadratic") {
        EXPECT_EQ(worst, 0) << shape.name;
      }
      ++n_shapes;
    }
  }
  EXPECT_GE(n_shapes, 16);
}

TEST(ExecutorBarrier, FoldsTheStiffnessIntoShapesWithAPotential) {
  int n_shapes = 0;
  for (const Shape& shape : all_shapes()) {
    const BarrierFunction barrier{shape, Argument::gap};
    if (!has_potential(barrier)) {
      EXPECT_THROW(ExecutorBarrier(barrier, true), ConfigError) << shape.name;
      continue;
    }
    TestedExecutor executor;
    ExecutorRows rows(executor, KappaColumns::potential);
    fill(rows);
    ExecutorBarrier(barrier, true).evaluate(executor, rows);
    const RowView v = rows.view();
    std::vector<KappaParts> parts;
    for (Index r = 0; r < n_gaps; ++r) parts.push_back({v.kappa[r], v.per_gap_sq[r]});
    std::vector<double> e(n_gaps), de(n_gaps), d2e(n_gaps);
    FoldedBarrier(barrier).eval(n_gaps, v.d, v.d_hat, parts.data(), e.data(), de.data(), d2e.data());
    double worst = 0;
    for (std::size_t r = 0; r < e.size(); ++r) {
      worst = std::max({worst, relative(v.energy[r], e[r]), relative(v.force[r], de[r]),
                        relative(v.stiffness[r], d2e[r])});
    }
    EXPECT_LE(worst, 1e-13);
    EXPECT_GT(e[0], 0);
    ++n_shapes;
  }
  EXPECT_EQ(n_shapes, 2);
}

/// Of a plugin, of a formula, with an exponent: by the call that the CPU path makes, in the memory of the host.
TEST(ExecutorBarrier, CallsAShapeWithoutAKernelForEveryRow) {
  int n_active = 0;
  for (const char* name : {"exponential:4", "minimax:4", "cubic"}) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      exec::HostExecutor executor(exec::Order::shuffled);
      ExecutorRows rows(executor, KappaColumns::kept);
      fill(rows);
      BarrierFunction barrier{require_shape(name), argument};
      barrier.shape.name = "from_a_plugin", barrier.shape.launches = nullptr;
      ExecutorBarrier(barrier, false, true).evaluate(executor, rows);
      const RowView v = rows.view();
      for (Index r = 0; r < n_gaps; ++r) {
        const ShapeTerms<double> one = barrier.eval(v.d[r], v.d_hat[r]);
        ASSERT_EQ(v.energy[r], v.kappa[r] * one.b) << name;
        ASSERT_EQ(v.force[r], v.kappa[r] * one.db) << name;
        ASSERT_EQ(v.stiffness[r], v.kappa[r] * one.d2b) << name;
        n_active += one.db < 0;
      }
    }
  }
  EXPECT_GT(n_active, 1800);
  BarrierFunction unknown{require_shape("cubic")};
  unknown.shape.name = "from_a_plugin", unknown.shape.launches = nullptr;
  EXPECT_THROW(ExecutorBarrier(unknown, true, true), ConfigError);  // no potential of its own
}

TEST(ExecutorBarrier, RefusesWhatHasNoKernelByName) {
  Shape plugin = require_shape("cubic");
  plugin.name = "from_a_plugin", plugin.launches = nullptr;
  try {
    ExecutorBarrier(BarrierFunction{plugin}, false);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("from_a_plugin"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("./bench list shapes"), std::string::npos);
  }
  BarrierFunction literal{require_shape("log")};
  literal.literal = true;
  EXPECT_THROW(ExecutorBarrier(literal, false), ConfigError);
  BarrierFunction single{require_shape("log")};
  single.in_float = true;
  EXPECT_THROW(ExecutorBarrier(single, false), ConfigError);
  EXPECT_THROW(ExecutorBarrier(BarrierFunction{require_shape("cubic"), Argument::squared_gap}, true),
               ConfigError);
}

}  // namespace
}  // namespace bb::test::executor_shapes_test
