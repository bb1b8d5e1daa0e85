// Runs the cases of a PTX test, without those of BB_PTX_SKIP unless a filter is given. A run without a filter also has to
// execute BB_PTX_LEAST per cent of the instructions of each of BB_PTX_MODULES.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/ptx/report.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const bool all = testing::GTEST_FLAG(filter) == "*";
  if (all) testing::GTEST_FLAG(filter) = "-" BB_PTX_SKIP;
  const int failed = RUN_ALL_TESTS();
  ptx::write_profile();
  if (testing::GTEST_FLAG(list_tests) || failed) return failed;
  if (const char* fault = std::getenv("BB_PTX_FAULT")) {  // coverage is no judge of a broken instruction
    if (fault == std::string_view("list")) ptx::list_faults();
    return 0;
  }
  if (!all || ptx::report(BB_PTX_LEAST / 100.0, BB_PTX_MODULES)) return 0;
  std::printf("less than %d %% of the instructions ran\n", BB_PTX_LEAST);
  return 1;
}
