// The kernels of core/resident/system, each against a plain loop.
#include "core/resident/system/system_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/exec/host_executor.hpp"
#include "core/resident/sums/resident_sum.hpp"

namespace bb::resident {
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
  exec::HostExecutor executor;
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
  executor.each(b.size(), AddColumn{g.data(), b.data()});
  executor.each(b.size(), ScaleColumn{0.3, b.data()});
  found = b.download();
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(found[i], 0.3 * (-(a[i] + c[i]) + a[i]));
  ResidentLeast least(executor);
  least.add(b.size() / 3, ColumnNorms{g.data()});
  double longest = 0;
  for (std::size_t v = 0; v < n / 3; ++v) {
    longest = std::max(
        longest, std::sqrt(a[3 * v] * a[3 * v] + a[3 * v + 1] * a[3 * v + 1] + a[3 * v + 2] * a[3 * v + 2]));
  }
  ASSERT_GT(longest, 1);
  EXPECT_EQ(least.largest(), longest);
}

/// Rows of five kinds, some of them mollified, with a stiffness of their own or one for all.
struct SomeRows {
  static constexpr std::size_t n = 1000;
  std::vector<double> d = positive(3), d_hat = positive(4), kappa = positive(5), push = positive(6),
                      stretch = positive(7);
  std::vector<std::uint8_t> kind;
  exec::Buffer<double> d_on, d_hat_on, kappa_on, push_on, stretch_on;
  exec::Buffer<std::uint8_t> kind_on;

  static std::vector<double> positive(unsigned seed) {
    std::vector<double> out = random_numbers(n, seed);
    for (double& x : out) x = x * x + 0.1;
    return out;
  }
  explicit SomeRows(exec::Executor& executor)
      : d_on(on(executor, d)),
        d_hat_on(on(executor, d_hat)),
        kappa_on(on(executor, kappa)),
        push_on(executor, "pushes"),
        stretch_on(on(executor, stretch)),
        kind_on(executor, "kinds") {
    for (double& x : push) x = -x;  // kappa b' is not positive
    push_on.upload(push);
    for (std::size_t r = 0; r < n; ++r) kind.push_back(static_cast<std::uint8_t>(r % 6));
    kind_on.upload(kind);
  }
  RowView view(bool uniform) {
    RowView out{};
    out.n = n;
    out.d = d_on.data(), out.d_hat = d_hat_on.data(), out.kind = kind_on.data();
    out.push = push_on.data(), out.stretch = stretch_on.data();
    out.kappa = uniform ? nullptr : kappa_on.data();
    out.uniform_kappa = 7;
    return out;
  }
  double number(RowNumber which, bool uniform, std::size_t r) const {
    const bool mollified = kind[r] == mollified_kind;
    switch (which) {
      case RowNumber::gap_rel:
        return d[r] / d_hat[r];
      case RowNumber::kappa:
        return uniform ? 7 : kappa[r];
      case RowNumber::load:
        return mollified ? 0 : -push[r];
      case RowNumber::curvature:
        break;
    }
    return mollified ? 0 : stretch[r];
  }
};

TEST(SystemKernels, NumbersOfRows) {
  exec::HostExecutor executor;
  SomeRows rows(executor);
  ResidentLeast least(executor);
  ResidentSum sum(executor);
  for (const RowNumber which :
       {RowNumber::gap_rel, RowNumber::kappa, RowNumber::load, RowNumber::curvature}) {
    for (const bool uniform : {false, true}) {
      double largest = 0, smallest = 1e300, total = 0;
      for (std::size_t r = 0; r < rows.n; ++r) {
        const double number = rows.number(which, uniform, r);
        largest = std::max(largest, number), smallest = std::min(smallest, number), total += number;
      }
      least.clear();
      least.add(rows.n, SmallestRow{{rows.view(uniform), which}});
      EXPECT_EQ(least.smallest(), smallest);
      least.clear();
      least.add(rows.n, LargestRow{{rows.view(uniform), which}});
      EXPECT_EQ(least.largest(), largest);
      sum.clear();
      sum.add(rows.n, SumOfLoads{{rows.view(uniform), which}});
      EXPECT_NEAR(sum.get().value(), total, 1e-12 * total);
      ASSERT_GT(largest, 1);
    }
  }
}

TEST(SystemKernels, ProductOverFreeNumbers) {
  exec::HostExecutor executor;
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
  ResidentSum sum(executor);
  sum.add(3 * n, FreeDot{a_on.data(), b_on.data(), fixed_on.data()});
  ASSERT_NE(expected, 0);
  EXPECT_NEAR(sum.get().value(), expected, 1e-13);
}

TEST(SystemKernels, RowsOfAKind) {
  exec::HostExecutor executor;
  SomeRows rows(executor);
  for (std::uint8_t kind = 0; kind <= mollified_kind; ++kind) {
    ResidentSum sum(executor);
    sum.add(rows.n, CountOfKind{rows.view(true), kind});
    const auto expected = std::count(rows.kind.begin(), rows.kind.end(), kind);
    EXPECT_EQ(sum.get().value(), static_cast<double>(expected));
    EXPECT_GT(expected, 0);
  }
}

}  // namespace
}  // namespace bb::resident
