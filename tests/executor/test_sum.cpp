// Sums, maxima and first items over columns of an executor.
#include "core/exec/sums/executor_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec::executor_sum_test {
namespace {

using test::all_orders;

/// n numbers over forty powers of ten, each with its negative nearby, so that little is left of their sum.
std::vector<double> cancelling(std::size_t n) {
  std::mt19937_64 random(n);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> out;
  while (out.size() + 1 < n) {
    const double large = u(random) * std::pow(10.0, 10 * u(random));
    out.push_back(large);
    out.push_back(-large + u(random) * 1e-6);
  }
  while (out.size() < n) out.push_back(u(random));
  std::shuffle(out.begin(), out.end(), random);
  return out;
}

TEST(ExecutorSum, LosesNothingOfACancellingSum) {
  for (const std::size_t n : {1u, 2u, 255u, 257u, 5000u, 262144u, 262145u, 1310721u}) {
    const std::vector<double> values = cancelling(n);
    long double exact = 0, carry = 0, magnitude = 0;  // twice the digits again
    double plain = 0;
    for (const double v : values) {
      const long double next = exact + v, back = next - exact;
      carry += (exact - (next - back)) + (v - back);
      exact = next;
      magnitude += std::abs(v);
      plain += v;
    }
    exact += carry;
    test::TestedExecutor executor;
    exec::Buffer<double> column(executor, "column");
    column.upload(values);
    ExecutorSum sum(executor);
    sum.add(column.size(), ColumnSum{column.data()});
    const Compensated found = sum.get();
    const double expected = static_cast<double>(exact);
    ASSERT_NE(expected, 0);
    const double eps = std::numeric_limits<double>::epsilon();
    EXPECT_NEAR(found.value(), expected, eps * std::abs(expected) + 1e-25 * static_cast<double>(magnitude))
        << n;
    EXPECT_NEAR(found.magnitude, static_cast<double>(magnitude), 1e-13 * static_cast<double>(magnitude));
    EXPECT_TRUE(n < 1000 || std::abs(plain - expected) > 1e3 * eps * std::abs(expected));
  }
}

TEST(ExecutorSum, AddsWhatComesAndTakesWhatGoes) {
  test::TestedExecutor executor;
  exec::Buffer<double> from(executor, "from"), to(executor, "to");
  from.upload(std::vector<double>{1e16, 3, 5});
  to.upload(std::vector<double>{1e16, 2, 7, 0.5});
  ExecutorSum sum(executor);
  EXPECT_EQ(sum.get().value(), 0);
  exec::Buffer<double> gone(executor, "gone");
  gone.upload(std::vector<double>{-1e16, -3, -5});
  sum.add(3, ColumnSum{gone.data()});
  sum.add(4, ColumnSum{to.data()});
  EXPECT_EQ(sum.get().value(), 1.5);
  EXPECT_EQ(sum.get().magnitude, 2e16 + 17.5);
  sum.clear();
  sum.add(3, ColumnChange{from.data(), to.data()});
  EXPECT_EQ(sum.get().value(), 1);
  sum.add(0, ColumnSum{nullptr});
  EXPECT_EQ(sum.get().value(), 1);
}

// Several items a thread, in every kernel over columns.
TEST(ExecutorSum, TakesMoreItemsThanThreads) {
  constexpr std::size_t n = 1'310'721;
  ASSERT_GT(items_a_block(n), 5 * exec::block_threads);
  std::vector<double> values(n), others(n);
  long double change = 0;
  double largest = 0, largest_free = 0;
  for (std::size_t i = 0; i < n; ++i) {
    values[i] = std::sin(0.7 * static_cast<double>(i));
    others[i] = std::cos(1.3 * static_cast<double>(i)) + 1e-3;
    const bool is_free = i / 3 % 2 == 0;
    change += static_cast<long double>(others[i]) - values[i];
    largest = std::max(largest, std::abs(values[i]));
    if (is_free) largest_free = std::max(largest_free, std::abs(values[i]));
  }
  std::vector<FixedMask> fixed(n / 3 + 1);
  for (std::size_t v = 0; v < fixed.size(); ++v) fixed[v] = v % 2 == 0 ? 0 : 7;
  test::TestedExecutor executor;
  exec::Buffer<double> a(executor, "a"), b(executor, "b");
  exec::Buffer<FixedMask> mask(executor, "mask");
  a.upload(values), b.upload(others), mask.upload(fixed);
  ExecutorSum sum(executor);
  sum.add(a.size(), ColumnChange{a.data(), b.data()});
  ASSERT_GT(change, 1000);
  EXPECT_NEAR(sum.get().value(), static_cast<double>(change), 1e-12 * static_cast<double>(change));
  ExecutorLeast least(executor);
  least.add(a.size(), ColumnSize{a.data()});
  EXPECT_EQ(least.largest(), largest);
  least.clear();
  least.add(a.size(), FreeSize{a.data(), mask.data()});
  EXPECT_EQ(least.largest(), largest_free);
}

TEST(ExecutorSum, HasTheSameBitsInEveryOrder) {
  const std::vector<double> values = cancelling(300000);
  std::vector<double> seen;
  for (const auto& executor : all_orders()) {
    exec::Buffer<double> column(*executor, "column");
    column.upload(values);
    ExecutorSum sum(*executor);
    sum.add(column.size(), ColumnSum{column.data()});
    const Compensated found = sum.get();
    for (const double number : {found.sum, found.carry, found.magnitude}) seen.push_back(number);
  }
  ASSERT_EQ(seen.size(), 15u);
  for (std::size_t i = 3; i < seen.size(); ++i) EXPECT_EQ(seen[i], seen[i - 3]);
  EXPECT_NE(seen[1], 0);  // something was carried
}

TEST(ExecutorLeast, FindsTheLargestAndTheSmallest) {
  for (const std::size_t n : {1u, 300u, 300000u}) {
    std::vector<double> values = cancelling(n);
    test::TestedExecutor executor(exec::Order::shuffled);
    exec::Buffer<double> column(executor, "column");
    column.upload(values);
    ExecutorLeast least(executor);
    EXPECT_EQ(least.largest(), 0);
    EXPECT_EQ(least.first(), -1);
    EXPECT_EQ(least.smallest(), std::numeric_limits<double>::infinity());
    least.add(column.size(), ColumnSize{column.data()});
    double expected = 0;
    for (const double v : values) expected = std::max(expected, std::abs(v));
    EXPECT_EQ(least.largest(), expected);
    values[n / 2] = std::nan("");
    column.upload(values);
    least.clear();
    least.add(column.size(), ColumnSize{column.data()});
    EXPECT_TRUE(std::isnan(least.largest()));
  }
}

TEST(Keys, CompareAsTheNumbersDo) {
  const double ascending[] = {-1e300, -1, -5e-324, 0, 5e-324, 0.1, 1, 1e300, INFINITY};
  for (std::size_t i = 0; i < std::size(ascending); ++i) {
    EXPECT_EQ(from_smallest_key(smallest_key(ascending[i])), ascending[i]);
    EXPECT_TRUE(ascending[i] < 0 || from_largest_key(largest_key(ascending[i])) == ascending[i]);
    if (i == 0) continue;
    EXPECT_LT(smallest_key(ascending[i - 1]), smallest_key(ascending[i]));
    EXPECT_TRUE(ascending[i - 1] < 0 || largest_key(ascending[i - 1]) > largest_key(ascending[i]));
  }
}

}  // namespace
}  // namespace bb::exec::executor_sum_test
