// Numbers that an executor's host reads: one wait for all of them, and none for what was read already.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "core/exec/board.hpp"
#include "core/exec/host_executor.hpp"

namespace bb::exec::board_test {
namespace {

struct Write {
  double* to;
  double value;
  void operator()(Index) const { *to = value; }
};

class CountedDownloads final : public HostExecutor {
 public:
  void download(void* to, const void* from, std::size_t bytes) override {
    ++downloads;
    HostExecutor::download(to, from, bytes);
  }
  int downloads = 0;
};

TEST(Board, ReadsAllNumbersAtOnceAndAgainWhenOneWasWritten) {
  CountedDownloads executor;
  Reading<double> first(executor), second(executor);
  executor.each(1, Write{first.to_write(), 1.5});
  executor.each(1, Write{second.to_write(), 2.5});
  EXPECT_EQ(first.get(), 1.5);
  EXPECT_EQ(second.get(), 2.5);
  EXPECT_EQ(executor.downloads, 1);
  executor.each(1, Write{first.to_write(), 3.5});
  EXPECT_EQ(second.get(), 2.5);
  EXPECT_EQ(first.get(), 3.5);
  EXPECT_EQ(executor.downloads, 2);
}

TEST(Board, APlaceThatWasGivenBackIsReadAnew) {
  CountedDownloads executor;
  Reading<double> other(executor);
  auto gone = std::make_unique<Reading<double>>(executor);
  executor.each(1, Write{gone->to_write(), 7});
  EXPECT_EQ(gone->get(), 7);
  const double* const place = gone->data();
  gone.reset();
  Reading<double> next(executor);
  ASSERT_EQ(next.data(), place);
  const int before = executor.downloads;
  next.get();
  EXPECT_EQ(executor.downloads, before + 1);  // what was read is the number of another
}

TEST(Board, WhatNothingWasWrittenToIsZero) {
  HostExecutor executor;
  const Reading<std::array<double, 4>> numbers(executor);
  EXPECT_EQ(numbers.get(), (std::array<double, 4>{}));
}

TEST(Board, IsRefusedWhenItIsFullAndGoesWithItsLastReading) {
  HostExecutor executor;
  {
    std::vector<std::unique_ptr<Reading<std::array<double, 512>>>> all;
    for (std::size_t k = 0; k < Board::capacity / 4096; ++k)
      all.push_back(std::make_unique<Reading<std::array<double, 512>>>(executor));
    EXPECT_THROW(Reading<double>{executor}, std::logic_error);
    EXPECT_EQ(executor.memory().bytes(), Board::capacity);
  }
  EXPECT_EQ(executor.memory().bytes(), 0u);
  Reading<double> again(executor);
  executor.each(1, Write{again.to_write(), 4});
  EXPECT_EQ(again.get(), 4);
}

}  // namespace
}  // namespace bb::exec::board_test
