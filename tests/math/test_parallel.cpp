// Loops on all threads: every item once, parts in one order, whatever the number of threads.
#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "core/math/parallel.hpp"

namespace bb {
namespace {

TEST(ParallelItems, CallsEveryItemOnce) {
  for (const int n : {0, 1, 63, 64, 65, 5000}) {
    std::vector<std::atomic<int>> calls(static_cast<std::size_t>(n));
    parallel_items(n, 64, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
    for (const std::atomic<int>& count : calls) EXPECT_EQ(count, 1) << n;
  }
  parallel_items(-1, 1, [](int) { FAIL() << "no item below 0"; });
}

/// Neighbouring items [begin, end), or that they were none.
struct Stretch {
  std::size_t begin = 0, end = 0, parts = 0;
  bool whole = true;
};

TEST(ReduceItems, MergesPartsInTheOrderOfItems) {
  for (const std::size_t n : {0, 1, 64, 65, 1000, 64 * 1024, 64 * 1024 + 1, 1'000'000}) {
    const Stretch all = reduce_items(
        n, 64, Stretch{},
        [](std::size_t begin, std::size_t end, const Stretch& start) {
          EXPECT_EQ(start.parts, 0u);
          return Stretch{begin, end, 1, true};
        },
        [](const Stretch& a, const Stretch& b) {
          return Stretch{a.begin, b.end, a.parts + b.parts, a.whole && b.whole && a.end == b.begin};
        });
    EXPECT_TRUE(all.whole) << n;
    EXPECT_EQ(all.end, n);
    EXPECT_LE(all.parts, 1024u);
    EXPECT_LE(all.parts, n_blocks(n, 64));
    EXPECT_EQ(all.parts == 0, n == 0);
  }
}

}  // namespace
}  // namespace bb
