// nvcc's PTX of the sample kernels against the same structs compiled by g++: bits, in every order of blocks and threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/exec/buffer.hpp"
#include "tests/exec/sample_kernels.hpp"
#include "tests/ptx/lockstep_executor.hpp"

namespace {

using namespace bb::exec;
using namespace bb::sample;

constexpr Order orders[] = {Order::forward, Order::reverse, Order::shuffled};

std::vector<double> numbers(std::size_t n, double size = 1) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-size, size);
  std::vector<double> out(n);
  for (double& x : out) x = u(random);
  return out;
}

template <class Run>
void expect_same_bits(const Run& run) {
  HostExecutor host(Order::forward);
  const auto expected = run(host);
  ASSERT_FALSE(expected.empty());
  EXPECT_TRUE(std::any_of(expected.begin(), expected.end(), [](auto x) { return x != 0; }));
  for (const Order order : orders) {
    ptx::PtxExecutor device(order, 5);
    const auto result = run(device);
    EXPECT_GT(device.launches(), 0u);
    ASSERT_EQ(result.size(), expected.size());
    EXPECT_EQ(memcmp(result.data(), expected.data(), expected.size() * sizeof expected[0]), 0);
  }
}

TEST(PtxExecutor, RunsItems) {
  expect_same_bits([](Executor& executor) {
    Buffer<double> in(executor, "in"), out(executor, "out", 1000);
    in.upload(numbers(1000));
    executor.each(1000, Square{in.data(), out.data()});
    return out.download();
  });
}

TEST(PtxExecutor, RunsBlocksAndTiles) {
  expect_same_bits([](Executor& executor) {
    Buffer<double> in(executor, "in"), out(executor, "out", 20);
    in.upload(numbers(20 * 256));
    executor.blocks(20, BlockSums{in.data(), out.data()});
    return out.download();
  });
  expect_same_bits([](Executor& executor) {
    Buffer<double> in(executor, "in"), out(executor, "out", 20);
    in.upload(numbers(20 * 256));
    executor.blocks(20, LargestOfSome{in.data(), out.data()});
    return out.download();
  });
}

template <int W>
void run_tiles() {
  expect_same_bits([](Executor& executor) {
    const Index n_tiles = 150;
    Buffer<double> in(executor, "in"), out(executor, "out", 3 * n_tiles);
    in.upload(numbers(static_cast<std::size_t>(3 * W * n_tiles)));
    out.fill_zero();
    executor.blocks(n_tiles * W / block_threads + 1, TileSums<W>{in.data(), out.data(), n_tiles});
    return out.download();
  });
}
TEST(PtxExecutor, RunsTilesThatPartWays) { run_tiles<4>(), run_tiles<32>(); }

TEST(PtxExecutor, RunsAtomics) {
  expect_same_bits([](Executor& executor) {
    Buffer<double> in(executor, "in");
    Buffer<Key> least(executor, "least");
    Buffer<std::uint32_t> bits(executor, "bits");
    in.upload(numbers(700)), least.upload(std::vector<Key>{~Key{0}}),
        bits.upload(std::vector<std::uint32_t>{0, 0});
    executor.each(700, Atomics{in.data(), least.data(), bits.data(), bits.data() + 1});
    EXPECT_EQ(bits.get(1), 700u);
    return std::vector<Key>{least.get(0), bits.get(0), bits.get(1)};
  });
}

TEST(PtxExecutor, LetsTheLastArrivalReadWhatAllWrote) {
  for (const Index n : {1, 255, 700}) {
    expect_same_bits([=](Executor& executor) {
      Buffer<double> in(executor, "in"), square(executor, "square", n), total(executor, "total", 1);
      Buffer<std::uint32_t> arrivals(executor, "arrivals");
      in.upload(numbers(static_cast<std::size_t>(n))), arrivals.upload(std::vector<std::uint32_t>{0});
      executor.each(n, LastArrival{in.data(), square.data(), arrivals.data(), total.data(), n});
      return total.download();
    });
  }
}

TEST(PtxExecutor, RunsStacksInLocalMemory) {
  expect_same_bits([](Executor& executor) {
    Buffer<double> in(executor, "in"), out(executor, "out", 300);
    in.upload(numbers(64));
    executor.each(300, Walk{in.data(), out.data(), 64});
    return out.download();
  });
}

TEST(PtxExecutor, RunsIntegers) {
  for (const int divisor : {7, -13}) {
    expect_same_bits([=](Executor& executor) {
      std::mt19937_64 random(3);
      std::vector<std::uint64_t> values(1000);
      for (auto& x : values) x = random() >> (random() % 60);
      Buffer<std::uint64_t> in(executor, "in");
      Buffer<std::int64_t> out(executor, "out", 6000);
      in.upload(values);
      executor.each(1000, Integers{in.data(), out.data(), divisor});
      return out.download();
    });
  }
}

// Different libraries: sin and the like are right to a unit or two in the last place on both sides. Numbers of every size,
// and those around which results overflow or lose digits: exp from 709.8 and to -745, x^1.5 from 1e205 and to 1e-216.
TEST(PtxExecutor, RunsTheLibraryOfTheDevice) {
  std::vector<double> values = numbers(3000, 10);
  for (std::size_t i = 0; i < 300; ++i) values[i] *= 1e6, values[300 + i] *= 1e-9, values[600 + i] *= 1e100;
  values[0] = 0, values[1] = 1e-320, values[2] = -0.0, values[3] = 1e-310;
  values[4] = INFINITY, values[5] = -INFINITY, values[6] = NAN, values[7] = 1e308, values[8] = -1e308,
  values[9] = 1;
  for (std::size_t i = 900; i < 1200; ++i)
    values[i] = std::ldexp(values[i], static_cast<int>(7 * i % 2040) - 1030);
  for (std::size_t i = 1200; i < 1300; ++i)
    values[i] = (i % 2 == 0 ? 708 : -746) + 0.02 * static_cast<double>(i - 1200);
  for (std::size_t i = 1300; i < 1400; ++i) values[i] *= i % 2 == 0 ? 2e204 : 1e-212;
  std::vector<std::vector<double>> results;
  HostExecutor host(Order::forward);
  ptx::PtxExecutor device;
  for (Executor* executor : {static_cast<Executor*>(&host), static_cast<Executor*>(&device)}) {
    Buffer<double> in(*executor, "in"), out(*executor, "out", 8 * 3000);
    in.upload(values);
    executor->each(3000, Library{in.data(), out.data()});
    results.push_back(out.download());
  }
  double worst = 0;
  for (std::size_t i = 0; i < results[0].size(); ++i) {
    const double a = results[0][i], b = results[1][i];
    if (a == b || (std::isnan(a) && std::isnan(b))) continue;
    ASSERT_TRUE(std::isfinite(a) && std::isfinite(b)) << "function " << i % 8 << " of " << values[i / 8];
    worst = std::max(worst, std::fabs(a - b) / std::max(std::fabs(a), 1e-300));
    ASSERT_NEAR(a, b, 1e-15 * std::max(std::fabs(a), 1e-300))
        << "function " << i % 8 << " of " << values[i / 8];
  }
  EXPECT_GT(worst, 0);  // they are two libraries
  RecordProperty("worst relative difference", std::to_string(worst));
}

TEST(LockstepExecutor, ComparesHostAndDevice) {
  ptx::LockstepExecutor both;
  Buffer<double> in(both, "in"), out(both, "out", 256);
  in.upload(numbers(32 * 64));
  both.each(64, Square{in.data(), out.data()});
  both.blocks(8, BlockSums{in.data(), out.data()});
  EXPECT_EQ(both.launches(), 2u);
  EXPECT_NE(out.get(0), 0);
  Buffer<double> library(both, "library", 8 * 64);
  EXPECT_THROW(both.each(64, Library{in.data(), library.data()}), ExecutionError);
}

TEST(PtxExecutor, ReplaysGraphs) {
  expect_same_bits([](Executor& executor) {
    Buffer<double> x(executor, "x");
    x.upload(std::vector<double>{1.1, 3});
    executor.begin_capture();
    executor.each(2, Square{x.data(), x.data()});
    const auto graph = executor.end_capture();
    executor.replay(*graph), executor.replay(*graph);
    return x.download();
  });
}

TEST(PtxExecutor, CountsTrafficOfAWarp) {
  ptx::PtxExecutor device;
  device.machine().profile = true;
  const ptx::Kernel* kernel = ptx::find_instance("run_each", "bb::sample::Square");
  ASSERT_NE(kernel, nullptr);
  Buffer<double> in(device, "in"), out(device, "out", 256);
  in.upload(numbers(256));
  const void* params[] = {reinterpret_cast<void*>(std::uintptr_t{256}), in.data(), out.data()};
  std::mt19937_64 random;
  device.machine().launch(*kernel, params, sizeof params, 1, 256, ptx::Order::forward, random);
  const ptx::TrafficOfBuffers& traffic = device.machine().traffic.at(kernel->name);
  ASSERT_EQ(traffic.size(), 2u);
  for (const char* buffer : {"in", "out"}) {
    const ptx::Traffic& t = traffic.at(buffer);
    EXPECT_EQ(t.requests, 8u);  // one a warp
    EXPECT_EQ(t.lines, 16u);    // 32 numbers of 8 bytes: 2 lines
    EXPECT_EQ(t.sectors, 64u);
    EXPECT_EQ(t.least, 64u);
  }
}

}  // namespace
