// The kernels of core/exec/sums alone: a product over the free degrees of freedom, at sizes of one block, of many, and
// of several items a thread.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/exec/host_executor.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec::sum_kernels_test {
namespace {

using test::TestedExecutor;

struct Columns {
  std::vector<double> a, b;
  std::vector<FixedMask> fixed;
  explicit Columns(Index vertices) : fixed(static_cast<std::size_t>(vertices)) {
    std::mt19937_64 random(static_cast<std::uint64_t>(vertices));
    std::uniform_real_distribution<double> u(-1, 1);
    for (FixedMask& mask : fixed) mask = static_cast<FixedMask>(random() % 3 == 0 ? random() % 8 : 0);
    for (Index i = 0; i < 3 * vertices; ++i) a.push_back(u(random)), b.push_back(u(random));
  }
};

Compensated free_dot(exec::Executor& executor, const Columns& columns, int times) {
  Buffer<double> a(executor, "first factor"), b(executor, "second factor");
  Buffer<FixedMask> fixed(executor, "fixed degrees of freedom");
  a.upload(columns.a), b.upload(columns.b), fixed.upload(columns.fixed);
  ExecutorSum sum(executor);
  for (int k = 0; k < times; ++k) sum.add(a.size(), FreeDot{a.data(), b.data(), fixed.data()});
  return sum.get();
}

TEST(SumKernels, MultiplyOverTheFreeDegreesOfFreedom) {
  int n_fixed = 0;
  for (const Index vertices : {1, 85, 86, 1000, 88000, 262200}) {
    const Columns columns(vertices);
    long double expected = 0, magnitude = 0;
    for (std::size_t i = 0; i < columns.a.size(); ++i) {
      if (is_fixed(columns.fixed[i / 3], static_cast<int>(i % 3))) {
        ++n_fixed;
        continue;
      }
      const double product = columns.a[i] * columns.b[i];
      expected += product, magnitude += std::abs(product);
    }
    std::vector<Compensated> seen;
    for (const Order order : {Order::forward, Order::reverse, Order::shuffled}) {
      TestedExecutor executor(order, 5);
      seen.push_back(free_dot(executor, columns, 2));
      EXPECT_NEAR(seen.back().value(), static_cast<double>(2 * expected),
                  1e-15 * static_cast<double>(magnitude))
          << vertices;
      EXPECT_NEAR(seen.back().magnitude, static_cast<double>(2 * magnitude),
                  1e-13 * static_cast<double>(magnitude));
      EXPECT_EQ(seen.back().sum, seen[0].sum);
      EXPECT_EQ(seen.back().carry, seen[0].carry);
    }
    EXPECT_NE(seen[0].sum, 0);
  }
  EXPECT_GT(n_fixed, 1000);
}

}  // namespace
}  // namespace bb::exec::sum_kernels_test
