// The whole Newton step through the compiled device executor, and through PTX alone: outcomes, iterations and states are
// those of the host executor, bit for bit.
#include <gtest/gtest.h>

#include "core/exec/cuda/device_executor.hpp"
#include "tests/executor/same_runs.hpp"
#include "tests/ptx/ptx_executor.hpp"
#include "tests/standin/cudart.hpp"

namespace bb {
namespace {

class StandinSystem : public testing::TestWithParam<const char*> {};

TEST_P(StandinSystem, StepsWithTheBitsOfTheHost) {
  standin::reset();
  const std::vector<test::MakeExecutor> others = {[] { return std::make_unique<ptx::PtxExecutor>(); },
                                                  [] { return std::make_unique<cuda::DeviceExecutor>(); }};
  test::expect_same_runs(test::cloth_on_floor(), GetParam(), 4, others);
  test::expect_same_runs(test::touching(test::two_sheets(), 0.01), GetParam(), 2, others);
  EXPECT_EQ(standin::counts().fault, "");
  EXPECT_GT(standin::counts().launches, 1000);
  EXPECT_GT(standin::counts().replays, 1);
  EXPECT_EQ(standin::counts().in_use, 0u);
}

INSTANTIATE_TEST_SUITE_P(Shapes, StandinSystem, testing::Values("cubic", "quadratic"));

}  // namespace
}  // namespace bb
