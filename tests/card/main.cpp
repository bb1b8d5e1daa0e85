// Runs the cases of a test on a card. Without one it says why and ends with the code that ctest shows as skipped. Cases that
// launch no kernel prove nothing here, and fail.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/exec/cuda/device.hpp"
#include "tests/card/launched.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();
  const bb::cuda::DeviceProbe probe = bb::cuda::probe_device();
  if (!probe.usable) {
    std::printf("SKIPPED: %s\n", probe.why.c_str());
    return BB_SKIPPED;
  }
  const int failed = RUN_ALL_TESTS();
  long launches = 0, compared = 0;
  std::size_t differ = 0;
  for (const auto& [name, count] : bb::test::launched_kernels()) {
    launches += count.launches, compared += count.compared;
    if (count.differences == 0) continue;
    ++differ;
    std::printf("%ld of %ld launches differ: %s\n", count.differences, count.launches, name.c_str());
  }
  std::printf("%s: %zu kernels in %ld launches, %ld compared with the host, %zu kernels differ\n",
              probe.card.c_str(), bb::test::launched_kernels().size(), launches, compared, differ);
  return failed != 0 || launches == 0 ? 1 : 0;
}
