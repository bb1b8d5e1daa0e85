// The host executor: the same bits in every order from kernels that keep the rules of core/exec/kernel.hpp, other bits
// from one that does not; sort, scan and graphs.
#include "core/exec/host_executor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/exec/buffer.hpp"
#include "tests/exec/sample_kernels.hpp"

namespace {

using namespace bb::exec;
using bb::sample::BlockSums, bb::sample::LargestOfSome, bb::sample::Square;

constexpr Order all_orders[] = {Order::threads, Order::forward, Order::reverse, Order::shuffled};

/// Breaks the rules: a sum in the order of the items.
struct RunningSum {
  const double* in;
  double* sum;
  BB_HD void operator()(Index i) const { *sum += in[i]; }
};

/// Breaks the rules: reads what another thread wrote without a barrier.
struct MissingBarrier {
  struct Shared {
    double a[256];
  };
  double* out;
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    block.threads([&](int t) { shared.a[t] = 1; });
    block.threads([&](int t) {
      shared.a[t] = t;
      out[256 * b + t] = shared.a[(t + 1) % 256];
    });
  }
};

/// Records which of its forms an item came from.
struct OneOrFour {
  static constexpr int lanes = 4;
  double* out;
  BB_HD void operator()(Index i) const { out[i] = static_cast<double>(2 * i); }
  void abreast(Index i) const {
    for (Index k = i; k < i + lanes; ++k) out[k] = static_cast<double>(2 * k + 1);
  }
};

std::vector<double> numbers(std::size_t n) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> out(n);
  for (double& x : out) x = std::ldexp(u(random), static_cast<int>(random() % 40));
  return out;
}

template <class Kernel>
std::vector<double> result(Order order, Index n_out) {
  HostExecutor executor(order, 3);
  Buffer<double> in(executor, "in"), out(executor, "out", n_out);
  in.upload(numbers(256 * 20));
  out.fill_zero();
  if constexpr (requires { typename Kernel::Shared; }) {
    if constexpr (std::is_same_v<Kernel, MissingBarrier>) {
      executor.blocks(20, Kernel{out.data()});
    } else {
      executor.blocks(20, Kernel{in.data(), out.data()});
    }
  } else {
    executor.each(in.size(), Kernel{in.data(), out.data()});
  }
  return out.download();
}

TEST(HostExecutor, GivesTheSameBitsInEveryOrder) {
  const std::vector<double> squares = result<Square>(Order::threads, 256 * 20),
                            sums = result<BlockSums>(Order::threads, 20), in = numbers(256 * 20);
  for (std::size_t i = 0; i < in.size(); ++i) ASSERT_EQ(squares[i], in[i] * in[i]);
  for (std::size_t b = 0; b < 20; ++b) {
    const double exact = std::accumulate(in.begin() + 256 * static_cast<long>(b),
                                         in.begin() + 256 * static_cast<long>(b + 1), 0.0);
    ASSERT_NE(exact, 0);
    EXPECT_NEAR(sums[b], exact, 1e-14 * std::ldexp(256.0, 40));
  }
  for (const Order order : all_orders) {
    EXPECT_EQ(result<Square>(order, 256 * 20), squares);
    EXPECT_EQ(result<BlockSums>(order, 20), sums);
  }
}

TEST(HostExecutor, RunsSomeThreadsOfABlock) {
  const std::vector<double> in = numbers(256 * 20);
  for (const Order order : all_orders) {
    const std::vector<double> most = result<LargestOfSome>(order, 20);
    int beyond = 0;  // blocks whose largest number is of a thread that has nothing to do
    for (std::size_t b = 0; b < 20; ++b) {
      const auto begin = in.begin() + 256 * static_cast<long>(b);
      EXPECT_EQ(most[b], *std::max_element(begin, begin + LargestOfSome::some));
      beyond += *std::max_element(begin, begin + 256) > most[b] ? 1 : 0;
    }
    EXPECT_GT(beyond, 0);
  }
}

TEST(HostExecutor, TakesItemsAbreastWhereTheyAreInNoOrder) {
  constexpr Index n = 1030;
  for (const Order order : all_orders) {
    HostExecutor executor(order, 3);
    Buffer<double> out(executor, "out", n);
    out.fill_zero();
    executor.each(n, OneOrFour{out.data()});
    const std::vector<double> got = out.download();
    Index abreast = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      const auto k = static_cast<std::size_t>(got[i]);
      ASSERT_EQ(k / 2, i);
      abreast += static_cast<Index>(k % 2);
    }
    EXPECT_EQ(abreast % OneOrFour::lanes, 0);
    EXPECT_EQ(abreast > 0, order == Order::threads);
    EXPECT_TRUE(abreast == 0 || abreast > n / 2);
  }
}

TEST(HostExecutor, ShowsKernelsThatDependOnTheOrder) {
  const auto sum = result<RunningSum>(Order::forward, 1);
  EXPECT_NE(result<RunningSum>(Order::reverse, 1), sum);
  EXPECT_NE(result<RunningSum>(Order::shuffled, 1), sum);
  const auto ahead = result<MissingBarrier>(Order::forward, 256 * 20);
  EXPECT_NE(result<MissingBarrier>(Order::reverse, 256 * 20), ahead);
  EXPECT_NE(result<MissingBarrier>(Order::shuffled, 256 * 20), ahead);
}

TEST(HostExecutor, SortsStablyByTheLowBits) {
  HostExecutor executor;
  std::mt19937_64 random(5);
  for (const int bits : {1, 11, 23, 64}) {
    std::vector<Key> keys(5000);
    for (Key& key : keys) key = random();
    std::vector<std::uint32_t> place(keys.size());
    std::iota(place.begin(), place.end(), 0u);
    const Key mask = bits == 64 ? ~Key{0} : (Key{1} << bits) - 1;
    std::vector<std::uint32_t> expected = place;
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return (keys[a] & mask) < (keys[b] & mask); });
    Buffer<Key> k(executor, "keys");
    Buffer<std::uint32_t> v(executor, "values");
    k.upload(keys), v.upload(place);
    executor.sort(k.data(), v.data(), k.size(), bits);
    EXPECT_EQ(v.download(), expected);
    for (std::size_t i = 0; i < keys.size(); ++i) ASSERT_EQ(k.data()[i], keys[expected[i]]);
    k.upload(keys);
    executor.sort(k.data(), nullptr, k.size(), bits);
    for (std::size_t i = 0; i < keys.size(); ++i) ASSERT_EQ(k.data()[i], keys[expected[i]]);
  }
}

TEST(HostExecutor, ScansInPlace) {
  HostExecutor executor;
  Buffer<Index> values(executor, "values");
  values.upload(std::vector<Index>{3, 0, 5, 1});
  executor.exclusive_scan(values.data(), values.size());
  EXPECT_EQ(values.download(), (std::vector<Index>{0, 3, 3, 8}));
}

TEST(HostExecutor, ReplaysWhatWasCaptured) {
  HostExecutor executor;
  Buffer<double> x(executor, "x");
  x.upload(std::vector<double>{2, 3});
  executor.begin_capture();
  executor.each(x.size(), Square{x.data(), x.data()});
  executor.each(x.size(), Square{x.data(), x.data()});
  const auto graph = executor.end_capture();
  EXPECT_EQ(graph->size(), 2u);
  EXPECT_EQ(x.get(0), 2);  // nothing ran yet
  executor.replay(*graph);
  EXPECT_EQ(x.get(0), 16);
  executor.replay(*graph);
  EXPECT_EQ(x.get(1), std::pow(3.0, 16));
}

TEST(OrderedBits, CompareAsTheNumbersDo) {
  const double ascending[] = {0, 5e-324, 1e-300, 0.1, 1, 1e300};
  for (std::size_t i = 1; i < std::size(ascending); ++i) {
    EXPECT_LT(ordered_bits(ascending[i - 1]), ordered_bits(ascending[i]));
  }
  for (const double x : ascending) EXPECT_EQ(from_ordered_bits(ordered_bits(x)), x);
  Key least = ordered_bits(1.0);
  for (const double x : {0.7, 0.2, 0.9}) atomic_min(&least, ordered_bits(x));
  EXPECT_EQ(from_ordered_bits(least), 0.2);
}

}  // namespace
