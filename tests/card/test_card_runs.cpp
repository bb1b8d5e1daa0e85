// Whole runs on a card: memory of the card, streams, graphs, CUB's sort and scan. They end with the bits of the host executor.
#include <gtest/gtest.h>

#include "core/exec/cuda/device_executor.hpp"
#include "tests/card/launched.hpp"
#include "tests/executor/same_runs.hpp"

namespace bb {
namespace {

class CountedExecutor final : public cuda::DeviceExecutor {
 protected:
  void launch(const exec::KernelInfo& kernel, exec::Index n, const void* f) override {
    ++test::launched_kernels()[kernel.name()].launches;
    DeviceExecutor::launch(kernel, n, f);
  }
};

const std::vector<test::MakeExecutor> on_card = {[] { return std::make_unique<CountedExecutor>(); }};

class CardRuns : public testing::TestWithParam<const char*> {};

TEST_P(CardRuns, HaveTheBitsOfTheHost) {
  test::expect_same_runs(test::cloth_on_floor(), GetParam(), 20, on_card);
  test::expect_same_runs(test::touching(test::two_sheets(), 0.01), GetParam(), 10, on_card);
}

INSTANTIATE_TEST_SUITE_P(Shapes, CardRuns, testing::Values("cubic", "quadratic", "log"));

// racecheck slows a run down some thousandfold: these few steps have contact, and every stage of a Newton iteration.
TEST(CardRuns, FewStepsHaveTheBitsOfTheHost) {
  test::expect_same_runs(test::touching(test::two_sheets(), 0.01), "cubic", 1, on_card);
}

TEST(CardRuns, OnObstaclesHaveTheBitsOfTheHost) {
  for (const Scene& scene : {test::cloth_on_plate(), test::cloth_on_balls_and_bar()}) {
    test::expect_same_runs(scene, "log", 20, on_card);
  }
}

}  // namespace
}  // namespace bb
