// The checked run time refuses kernels that break a rule, with the kernel's name and the line of its PTX.
#include <gtest/gtest.h>

#include "core/exec/buffer.hpp"
#include "tests/ptx/faulty_kernels.hpp"
#include "tests/ptx/ptx_executor.hpp"

namespace {

using namespace bb::exec;
using namespace bb::faulty;

template <class Launch>
void expect_error(const Launch& launch, const std::vector<std::string>& parts) {
  for (const Order order : {Order::forward, Order::reverse, Order::shuffled}) {
    ptx::PtxExecutor device(order, 3);
    try {
      launch(device);
      ADD_FAILURE() << "no error of " << parts[0];
    } catch (const ExecutionError& error) {
      for (const std::string& part : parts)
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

TEST(PtxFaults, BoundsAndAlignment) {
  expect_error(
      [](Executor& e) {
        Buffer<double> out(e, "out", 10), beside(e, "beside", 10);
        e.each(10, OneTooFar{out.data()});
      },
      {"OneTooFar", "a store outside all allocations", "PTX line", "thread 9"});
  expect_error(
      [](Executor& e) {
        Buffer<double> in(e, "in", 10), out(e, "out", 10);
        e.each(10, ReadsBefore{in.data(), out.data()});
      },
      {"ReadsBefore", "a load outside all allocations", "thread 0"});
  expect_error(
      [](Executor& e) {
        Buffer<unsigned char> out(e, "out", 100);
        e.each(10, Misaligned{out.data()});
      },
      {"Misaligned", "misaligned access to global memory"});
}

TEST(PtxFaults, MemoryThatWasReleased) {
  expect_error(
      [](Executor& e) {
        Buffer<double> in(e, "in", 10), out(e, "out", 10);
        const double* dead = in.data();
        in.free();
        e.each(9, ReadsBefore{dead + 1, out.data()});
      },
      {"ReadsBefore", "a load outside"});
}

TEST(PtxFaults, Races) {
  Index blocks = 2;
  for (auto launch : {+[](Executor&e, Buffer<double>&out) { e.blocks(2, MissingBarrier{out.data()}); },
                      +[](Executor&e, Buffer<double>&out) { e.blocks(2, WritesTogether{out.data()}); }}) {
    expect_error(
        [&](Executor& e) {
          Buffer<double> out(e, "out", 256 * blocks);
          launch(e, out);
        },
        {"race", "since the last barrier"});
  }
}

TEST(PtxFaults, RacesOnGlobalMemory) {
  expect_error(
      [](Executor& e) {
        Buffer<double> x(e, "x");
        x.upload(std::vector<double>(300, 1.0));
        e.each(300, ReadsNeighbour{x.data(), 300});
      },
      {"ReadsNeighbour", "race", "in this launch"});
  expect_error(
      [](Executor& e) {
        Buffer<double> out(e, "out", 1);
        e.each(300, AllWriteOne{out.data()});
      },
      {"AllWriteOne", "race: writes global memory that another thread wrote"});
  expect_error(
      [](Executor& e) {
        Buffer<double> x(e, "x");
        x.upload(std::vector<double>(4, 1.0));
        e.blocks(3, ReadsNextBlock{x.data()});
      },
      {"ReadsNextBlock", "race", "in this launch"});
  expect_error(
      [](Executor& e) {
        Buffer<std::uint32_t> counter(e, "counter"), out(e, "out", 3);
        counter.upload(std::vector<std::uint32_t>{0});
        e.blocks(3, ReadsACounter{counter.data(), out.data()});
      },
      {"ReadsACounter", "race", "in this launch"});
  expect_error(
      [](Executor& e) {
        Buffer<double> x(e, "x"), out(e, "out", 2);
        x.upload(std::vector<double>{1});
        e.blocks(2, WritesWhatAnotherBlockRead{x.data(), out.data()});
      },
      {"WritesWhatAnotherBlockRead", "race", "in this launch"});
}

void run_last_block(Executor& e, bool with_fence, std::vector<double>* sums = nullptr) {
  Buffer<double> part(e, "part", 3);
  Buffer<std::uint32_t> ended(e, "ended");
  ended.upload(std::vector<std::uint32_t>{0});
  e.blocks(3, LastBlockReads{part.data(), ended.data(), 3, with_fence});
  if (sums) *sums = part.download();
}
TEST(PtxFaults, TheLastBlockNeedsTheFenceOfTheOthers) {
  expect_error([](Executor& e) { run_last_block(e, false); },
               {"LastBlockReads", "race: reads global memory that another thread wrote in this launch"});
  for (const Order order : {Order::forward, Order::reverse, Order::shuffled}) {
    ptx::PtxExecutor device(order, 3);
    std::vector<double> sums;
    run_last_block(device, true, &sums);
    EXPECT_EQ(sums.at(0), 3);
  }
}

TEST(PtxFaults, DeadlocksAndEndlessLoops) {
  expect_error(
      [](Executor& e) {
        Buffer<double> out(e, "out", 256);
        e.blocks(1, BarrierOfSome{out.data()});
      },
      {"BarrierOfSome", "deadlock", "at the barrier of PTX line"});
  expect_error(
      [](Executor& e) {
        Buffer<double> out(e, "out", 32);
        e.blocks(1, ShuffleOfSome{out.data()});
      },
      {"ShuffleOfSome", "deadlock", "at the shuffle of PTX line"});
  expect_error(
      [](Executor& e) {
        Buffer<double> in(e, "in"), out(e, "out", 1);
        in.upload(std::vector<double>{1, 0.5});
        e.each(1, Endless{in.data(), out.data()});
      },
      {"Endless", "runs without end"});
}

struct NotInTheList {
  BB_HD void operator()(Index) const {}
};
TEST(PtxFaults, KernelsWithoutPtx) {
  expect_error([](Executor& e) { e.each(1, NotInTheList{}); }, {"NotInTheList", "no PTX"});
}

}  // namespace
