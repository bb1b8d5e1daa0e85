// Buffers and who holds them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/exec/buffer.hpp"
#include "core/exec/counting_executor.hpp"
#include "core/exec/host_executor.hpp"

namespace {

using namespace bb::exec;

TEST(Buffer, IsCountedUnderItsName) {
  HostExecutor executor;
  {
    Buffer<double> a(executor, "a", 10);
    Buffer<int> b(executor, "b", 3);
    EXPECT_EQ(executor.memory().bytes(), 92u);
    EXPECT_EQ(executor.memory().by_name().at("a"), 80u);
    a.resize(4);  // the capacity stays
    EXPECT_EQ(executor.memory().by_name().at("a"), 80u);
    EXPECT_EQ(a.bytes(), 80u);
    a.grow(20);
    EXPECT_EQ(executor.memory().by_name().at("a"), 200u);
    EXPECT_EQ(a.size(), 20);
    a.free();
    EXPECT_EQ(executor.memory().by_name().count("a"), 0u);
    EXPECT_EQ(executor.memory().peak(), 212u);
    EXPECT_EQ(executor.memory().at_peak().at("b"), 12u);
  }
  EXPECT_EQ(executor.memory().bytes(), 0u);
}

TEST(Buffer, KeepsItsValues) {
  HostExecutor executor;
  Buffer<double> a(executor, "a", 2), b(executor, "b");
  EXPECT_TRUE(std::isnan(a.get(0)));  // fresh memory
  a.upload(std::vector<double>{1, 2});
  a.set(1, 5);
  b.copy_from(a);
  a.fill_zero();
  EXPECT_EQ(b.download(), (std::vector<double>{1, 5}));
  EXPECT_EQ(a.download(), (std::vector<double>{0, 0}));
  a.swap(b);
  EXPECT_EQ(a.get(1), 5);
  const Buffer<double> moved(std::move(a));
  EXPECT_EQ(moved.get(1), 5);
}

TEST(Buffer, RefusesWhatDoesNotFit) {
  HostExecutor executor;
  executor.limit_memory(100);
  Buffer<double> a(executor, "rows", 10);
  try {
    Buffer<double> b(executor, "matrix values", 1 << 20);
    FAIL();
  } catch (const OutOfMemory& error) {
    const std::string text = error.what();
    for (const char* part : {"matrix values", "8.00 MiB", "80 B", "100 B"}) {
      EXPECT_NE(text.find(part), std::string::npos) << text;
    }
  }
  EXPECT_EQ(executor.memory().bytes(), 80u);
  EXPECT_EQ(executor.memory().left(), 20u);
  executor.limit_memory(50);
  EXPECT_EQ(executor.memory().left(), 0u);
  executor.limit_memory(0);
  EXPECT_GT(executor.memory().left(), std::size_t{1} << 60);
  EXPECT_EQ(a.size(), 10);
}

TEST(CountingExecutor, CountsWithoutMemory) {
  CountingExecutor executor;
  Buffer<double> a(executor, "a", Index{1} << 40);
  a.fill_zero();
  EXPECT_EQ(executor.memory().bytes(), std::size_t{8} << 40);
  EXPECT_THROW(static_cast<void>(a.get(0)), std::logic_error);
}

}  // namespace
