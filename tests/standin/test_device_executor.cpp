// The device executor gives the bits of the host executor: kernels, graphs, sort, scan. Linked once with the stand-in
// for the CUDA run time, once with CUDA's own, where it needs a card.
#include "core/exec/cuda/device_executor.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/exec/cuda/block_size.hpp"
#include "core/exec/cuda/device.hpp"
#include "core/exec/cuda/kernel_table.hpp"
#include "core/exec/host_executor.hpp"
#include "tests/standin/device_kernels.hpp"
#ifdef BB_STANDIN
#include "tests/standin/cudart.hpp"
#endif

namespace bb::device_kernels {
void add_to(cuda::KernelTable& table);
}

namespace {

using namespace bb;
using namespace bb::exec;
using namespace bb::device_kernels;

std::vector<double> numbers(std::size_t n) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(0.5, 1);
  std::vector<double> out(n);
  for (double& x : out) x = std::ldexp(u(random), static_cast<int>(random() % 30));
  return out;
}

class OnDevice : public testing::Test {
 protected:
  void SetUp() override {
    const cuda::DeviceProbe probe = cuda::probe_device();
#ifdef BB_STANDIN
    ASSERT_TRUE(probe.usable) << probe.why;
#else
    if (!probe.usable) GTEST_SKIP() << probe.why;
#endif
    add_to(cuda::kernel_table());
    device = std::make_unique<cuda::DeviceExecutor>(1000);
  }
  std::unique_ptr<cuda::DeviceExecutor> device;
  HostExecutor host;
};

struct Results {
  std::vector<double> numbers;
  std::vector<std::uint32_t> flags;
  Key least;
  bool operator==(const Results&) const = default;
};

Results many_arguments(Executor& executor, Index n) {
  Buffer<double> out(executor, "out", n);
  Buffer<std::uint32_t> flags(executor, "flags", 2);
  Buffer<Key> least(executor, "least");
  flags.fill_zero();
  least.upload(std::vector<Key>{~Key{0}});
  ManyArguments kernel{-3, out.data(), 7, {}, flags.data(), 0.1f, least.data()};
  for (int i = 0; i < 30; ++i) kernel.table[i] = 1.0 / (i + 1);
  executor.each(n, kernel);
  return {out.download(), flags.download(), least.get(0)};
}

TEST_F(OnDevice, KernelsGetTheirArguments) {
  for (const Index n : {1, 255, 256, 257, 1000}) {
    const Results here = many_arguments(host, n);
    EXPECT_EQ(many_arguments(*device, n), here) << n;
    EXPECT_EQ(here.numbers[0], static_cast<double>(0.1f) - 21);
    EXPECT_EQ(here.flags[1], static_cast<std::uint32_t>(n * (n - 1) / 2));
  }
}

TEST(BlockSize, HasAsManyWarpsAsRegistersAllow) {
  static_assert(cuda::resident_warps(256, 138) == 8 && cuda::resident_warps(64, 138) == 14);
  for (const int registers : {0, 32, 40, 64, 80, 128, 208, 255}) {
    EXPECT_EQ(cuda::threads_of_block(registers), 256) << registers;
  }
  for (const int registers : {90, 129, 138, 160, 168}) {
    EXPECT_EQ(cuda::threads_of_block(registers), 64) << registers;
  }
}

std::vector<double> block_sums(Executor& executor, Index blocks) {
  Buffer<double> in(executor, "in"), out(executor, "out", 2 * blocks);
  in.upload(numbers(256 * static_cast<std::size_t>(blocks)));
  executor.blocks(blocks, BlockSums{in.data(), out.data()});
  return out.download();
}

TEST_F(OnDevice, BlocksAndTilesSumInTheSameTree) {
  const std::vector<double> sums = block_sums(host, 20);
  ASSERT_GT(sums[0], 256);
  EXPECT_EQ(block_sums(*device, 20), sums);
}

#ifdef BB_STANDIN
TEST_F(OnDevice, KernelsOfManyRegistersRunInSmallBlocks) {
  const Results here = many_arguments(host, 1000);
  EXPECT_EQ(many_arguments(*device, 1000), here);
  EXPECT_EQ(standin::counts().threads, 256u);
  standin::settings().registers = 138;
  cuda::DeviceExecutor small_blocks(1000);
  EXPECT_EQ(many_arguments(small_blocks, 1000), here);
  EXPECT_EQ(standin::counts().threads, 64u);
  EXPECT_EQ(standin::counts().blocks, 16u);
  EXPECT_EQ(block_sums(small_blocks, 3), block_sums(host, 3));
  EXPECT_EQ(standin::counts().threads,
            256u);  // the threads of a block share memory: they are as many as the kernel reports
  standin::settings().registers = 0;
}
#endif

TEST_F(OnDevice, GraphsRunWhatWasCaptured) {
  Buffer<double> x(*device, "x");
  x.upload(std::vector<double>{2, 3});
  device->begin_capture();
  device->each(x.size(), Square{x.data()});
  device->each(x.size(), Square{x.data()});
  const auto graph = device->end_capture();
  EXPECT_EQ(graph->size(), 2u);
  EXPECT_EQ(x.get(0), 2);  // nothing ran yet
  device->replay(*graph);
  EXPECT_EQ(x.get(0), 16);
  device->replay(*graph);
  EXPECT_EQ(x.get(1), std::pow(3.0, 16));
}

TEST_F(OnDevice, SortsAsTheHost) {
  std::mt19937_64 random(5);
  for (const int bits : {1, 8, 11, 16, 23, 64}) {
    std::vector<Key> keys(3000);
    for (Key& key : keys) key = random();
    std::vector<std::uint32_t> values(keys.size());
    for (std::uint32_t& value : values) value = static_cast<std::uint32_t>(random());
    std::vector<Key> sorted[2];
    std::vector<std::uint32_t> carried[2];
    Executor* executors[] = {&host, device.get()};
    for (int i = 0; i < 2; ++i) {
      Buffer<Key> k(*executors[i], "keys"), alone(*executors[i], "keys");
      Buffer<std::uint32_t> v(*executors[i], "values");
      k.upload(keys), alone.upload(keys), v.upload(values);
      executors[i]->sort(k.data(), v.data(), k.size(), bits);
      executors[i]->sort(alone.data(), nullptr, alone.size(), bits);
      sorted[i] = k.download(), carried[i] = v.download();
      EXPECT_EQ(alone.download(), sorted[i]);
    }
    EXPECT_NE(sorted[0], keys);
    EXPECT_EQ(sorted[1], sorted[0]) << bits;
    EXPECT_EQ(carried[1], carried[0]) << bits;
  }
  EXPECT_GE(device->memory().by_name().at("sort scratch"), 3000u * 12);
}

// The executor of this test scans in parts of 1000.
TEST_F(OnDevice, ScansAsTheHost) {
  for (const std::size_t n : {1u, 999u, 1000u, 1001u, 3500u}) {
    std::vector<Index> counts(n);
    for (std::size_t i = 0; i < n; ++i) counts[i] = static_cast<Index>(i * i % 17) + (Index{1} << 33);
    Buffer<Index> here(host, "counts"), there(*device, "counts");
    here.upload(counts), there.upload(counts);
    host.exclusive_scan(here.data(), here.size());
    device->exclusive_scan(there.data(), there.size());
    EXPECT_EQ(there.download(), here.download());
    EXPECT_EQ(here.get(0), 0);
  }
}

TEST_F(OnDevice, CopiesAndFills) {
  Buffer<double> a(*device, "a"), b(*device, "b");
  a.upload(numbers(5000));
  b.copy_from(a);
  a.set(3, 7);
  EXPECT_EQ(b.download(), numbers(5000));
  EXPECT_EQ(a.get(3), 7);
  a.fill_zero();
  EXPECT_EQ(a.download(), std::vector<double>(5000, 0));
  device->fill_bytes(nullptr, 0, 0);
  device->copy(nullptr, nullptr, 0);
}

TEST_F(OnDevice, TimesKernelsWhenAsked) {
  Buffer<double> x(*device, "x");
  x.upload(std::vector<double>{2});
  device->time_kernels();
  device->begin_capture();
  device->each(1, Square{x.data()});
  const auto graph = device->end_capture();
  device->replay(*graph), device->replay(*graph);
  EXPECT_EQ(x.get(0), 16);
  const cuda::KernelTime& time = device->profile().at("bb::device_kernels::Square");
  EXPECT_EQ(time.launches, 2);
  EXPECT_GT(time.seconds, 0);
}

TEST_F(OnDevice, RefusesAKernelWithoutADeviceVersion) {
  Buffer<double> x(*device, "x", 1);
  try {
    device->each(1, Unlisted{x.data()});
    FAIL();
  } catch (const ExecutionError& error) {
    EXPECT_NE(std::string(error.what()).find("bb::device_kernels::Unlisted: no device version"),
              std::string::npos);
  }
}

}  // namespace
