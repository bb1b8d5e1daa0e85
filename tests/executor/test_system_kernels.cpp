// The kernels of core/newton/executor, each against a plain loop.
#include "core/exec/sums/vector_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/contact/executor/sum_kernels.hpp"
#include "core/exec/host_executor.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec::system_kernels_test {
namespace {

std::vector<double> random_numbers(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> out(n);
  for (double& x : out) x = u(random);
  return out;
}

exec::Buffer<double> on(exec::Executor& executor, const std::vector<double>& values) {
  exec::Buffer<double> out(executor, "numbers");
  out.upload(values);
  return out;
}

TEST(SystemKernels, Columns) {
  test::TestedExecutor executor;
  const std::size_t n = 3 * 101;
  const std::vector<double> a = random_numbers(n, 1), c = random_numbers(n, 2);
  const auto g = on(executor, a), lifted = on(executor, c);
  exec::Buffer<double> b(executor, "b", static_cast<Index>(n));
  executor.each(b.size(), RightHandSide{g.data(), nullptr, b.data()});
  std::vector<double> found = b.download();
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(found[i], -a[i]);
  executor.each(b.size(), RightHandSide{g.data(), lifted.data(), b.data()});
  found = b.download();
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(found[i], -(a[i] + c[i]));
  executor.each(b.size(), ScaleColumn{0.3, b.data()});
  found = b.download();
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(found[i], 0.3 * -(a[i] + c[i]));
}

/// Rows of every kind, some of them mollified, with a stiffness of their own or one for all.
struct SomeRows {
  static constexpr std::size_t n = 1000;
  std::vector<double> d = positive(3), d_hat = positive(4), kappa = positive(5), force = positive(6),
                      stiffness = positive(7), energy = positive(10), mollifier;
  std::vector<std::uint8_t> kind;
  exec::Buffer<double> d_on, d_hat_on, kappa_on, force_on, stiffness_on, energy_on, mollifier_on;
  exec::Buffer<std::uint8_t> kind_on;
  exec::Buffer<std::uint32_t> mollified_on;

  static std::vector<double> positive(unsigned seed) {
    std::vector<double> out = random_numbers(n, seed);
    for (double& x : out) x = x * x + 0.1;
    return out;
  }
  explicit SomeRows(exec::Executor& executor)
      : d_on(on(executor, d)),
        d_hat_on(on(executor, d_hat)),
        kappa_on(on(executor, kappa)),
        force_on(executor, "forces"),
        stiffness_on(on(executor, stiffness)),
        energy_on(on(executor, energy)),
        mollifier_on(executor, "mollifiers"),
        kind_on(executor, "kinds"),
        mollified_on(executor, "mollified rows") {
    for (double& x : force) x = -x;  // kappa b' is not positive
    force_on.upload(force);
    for (std::size_t r = 0; r < n; ++r) kind.push_back(static_cast<std::uint8_t>(r % (mollified_kind + 1)));
    kind_on.upload(kind);
    std::vector<std::uint32_t> list;
    for (std::size_t r = 0; r < n; ++r) {
      if (!mollified(r)) continue;
      list.push_back(static_cast<std::uint32_t>(r));
      mollifier.push_back(0.5 + 1e-3 * static_cast<double>(r));
    }
    mollified_on.upload(list), mollifier_on.upload(mollifier);
  }
  RowView view(bool uniform) {
    RowView out{};
    out.n = n;
    out.d = d_on.data(), out.d_hat = d_hat_on.data(), out.kind = kind_on.data();
    out.force = force_on.data(), out.stiffness = stiffness_on.data(), out.energy = energy_on.data();
    out.kappa = uniform ? nullptr : kappa_on.data();
    out.uniform_kappa = 7;
    return out;
  }
  RowEnergy energy_of(const RowView& rows) {
    return {rows, {mollified_on.data(), mollified_on.size(), mollifier_on.data()}};
  }
  bool mollified(std::size_t r) const { return kind[r] == mollified_kind; }
  /// Energies of all rows, J, mollifiers included.
  std::vector<double> energies() const {
    std::vector<double> out;
    std::size_t next = 0;
    for (std::size_t r = 0; r < n; ++r)
      out.push_back(mollified(r) ? mollifier[next++] * energy[r] : energy[r]);
    return out;
  }
  /// Loads of all rows, N; 0 where they are mollified.
  std::vector<double> loads() const {
    std::vector<double> out;
    for (std::size_t r = 0; r < n; ++r) out.push_back(mollified(r) ? 0 : -force[r]);
    return out;
  }
};

RowTotals totals(exec::Executor& executor, const RowView& rows, const RowEnergy& energy) {
  ExecutorSums<RowTotals> sums(executor);
  sums.add(rows.n, TotalsOfRows{rows, energy});
  return sums.get();
}

/// a . b of all numbers, with the additions in the order of every sum over columns.
Compensated product(exec::Executor& executor, const std::vector<double>& a, const std::vector<double>& b) {
  const auto a_on = on(executor, a), b_on = on(executor, b);
  exec::Buffer<FixedMask> fixed(executor, "fixed", a_on.size() / 3 + 1);
  fixed.fill_zero();
  ExecutorSum sum(executor);
  sum.add(a_on.size(), FreeDot{a_on.data(), b_on.data(), fixed.data()});
  return sum.get();
}

TEST(SystemKernels, TotalsOfRowsAreThoseOfALoop) {
  test::TestedExecutor executor;
  SomeRows rows(executor);
  for (const bool uniform : {false, true}) {
    const RowView view = rows.view(uniform);
    const RowTotals found = totals(executor, view, rows.energy_of(view));
    double gap_rel = 1e300, kappa_min = 1e300, kappa_max = 0, curvature = 0;
    for (std::size_t r = 0; r < rows.n; ++r) {
      const double kappa = uniform ? 7 : rows.kappa[r];
      gap_rel = std::min(gap_rel, rows.d[r] / rows.d_hat[r]);
      kappa_min = std::min(kappa_min, kappa), kappa_max = std::max(kappa_max, kappa);
      if (!rows.mollified(r)) curvature = std::max(curvature, rows.stiffness[r]);
    }
    const std::vector<double> loads = rows.loads();
    EXPECT_EQ(smallest_of(found.gap_rel_min), gap_rel);
    EXPECT_EQ(smallest_of(found.kappa_min), kappa_min);
    EXPECT_EQ(largest_of(found.kappa_max), kappa_max);
    EXPECT_EQ(largest_of(found.load_max), *std::max_element(loads.begin(), loads.end()));
    EXPECT_EQ(largest_of(found.curvature_max), curvature);
    ASSERT_GT(curvature, 1);
    const Compensated load = product(executor, loads, std::vector<double>(rows.n, 1));
    ASSERT_GT(load.value(), 100);
    EXPECT_EQ(found.load.sum, load.sum);
    EXPECT_EQ(found.load.carry, load.carry);
    EXPECT_EQ(found.load.magnitude, load.magnitude);
    const Compensated energy = product(executor, rows.energies(), std::vector<double>(rows.n, 1));
    ASSERT_GT(energy.value(), 100);
    EXPECT_EQ(found.energy.sum, energy.sum);
    EXPECT_EQ(found.energy.carry, energy.carry);
    for (std::uint8_t kind = 0; kind <= mollified_kind; ++kind) {
      const auto expected = std::count(rows.kind.begin(), rows.kind.end(), kind);
      EXPECT_GT(expected, 0);
      EXPECT_EQ(found.of_kind[kind], static_cast<Key>(expected));
    }
  }
}

TEST(SystemKernels, TotalsOfRowsAreTheSameInEveryOrder) {
  std::vector<RowTotals> found;
  for (const exec::Order order :
       {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    test::TestedExecutor executor(order, 5);
    SomeRows rows(executor);
    const RowView view = rows.view(false);
    found.push_back(totals(executor, view, rows.energy_of(view)));
    EXPECT_EQ(std::memcmp(&found.back(), &found.front(), sizeof(RowTotals)), 0);
  }
  ASSERT_NE(found.front().load.carry, 0);
}

TEST(SystemKernels, TotalsOfNoRowsAndOfNoNumbers) {
  test::TestedExecutor executor;
  RowView none{};
  const RowTotals empty = totals(executor, none, RowEnergy{});
  EXPECT_EQ(smallest_of(empty.kappa_min), std::numeric_limits<double>::infinity());
  EXPECT_EQ(largest_of(empty.kappa_max), 0);
  EXPECT_EQ(empty.load.value(), 0);
  SomeRows rows(executor);
  rows.d_on.set(17, std::numeric_limits<double>::quiet_NaN());
  rows.stiffness_on.set(18, -std::numeric_limits<double>::quiet_NaN());
  const RowView view = rows.view(false);
  const RowTotals bad = totals(executor, view, rows.energy_of(view));
  EXPECT_TRUE(std::isnan(smallest_of(bad.gap_rel_min)));
  EXPECT_TRUE(std::isnan(largest_of(bad.curvature_max)));
  EXPECT_FALSE(std::isnan(largest_of(bad.load_max)));
}

TEST(SystemKernels, ProductOverFreeNumbers) {
  test::TestedExecutor executor;
  const std::size_t n = 101;
  const std::vector<double> a = random_numbers(3 * n, 8), b = random_numbers(3 * n, 9);
  std::vector<FixedMask> fixed(n);
  double expected = 0;
  for (std::size_t v = 0; v < n; ++v) {
    fixed[v] = static_cast<FixedMask>(v % 8);
    for (std::size_t k = 0; k < 3; ++k) expected += (v % 8 >> k & 1) != 0 ? 0 : a[3 * v + k] * b[3 * v + k];
  }
  const auto a_on = on(executor, a), b_on = on(executor, b);
  exec::Buffer<FixedMask> fixed_on(executor, "fixed");
  fixed_on.upload(fixed);
  ExecutorSum sum(executor);
  sum.add(3 * n, FreeDot{a_on.data(), b_on.data(), fixed_on.data()});
  ASSERT_NE(expected, 0);
  EXPECT_NEAR(sum.get().value(), expected, 1e-13);
}

}  // namespace
}  // namespace bb::exec::system_kernels_test
