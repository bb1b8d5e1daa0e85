// Which calibration runs a process keeps.
#include <gtest/gtest.h>

#include "experiments/run/calibration_run.hpp"

namespace bb::calibration_run_cache_test {
namespace {

TEST(CalibrationRunCache, KeepsWhatWasAskedForLastWithinItsBytes) {
  const auto calibration_run = [](const char* id, int states) {
    CalibrationRun out;
    out.config_id = id;
    out.x.assign(static_cast<std::size_t>(states), Positions::Zero(3, 10));  // 240 bytes each
    return out;
  };
  CalibrationRunCache cache(1000);
  cache.keep(calibration_run("a", 2));
  cache.keep(calibration_run("b", 2));
  ASSERT_NE(cache.find("a"), nullptr);
  const auto held = cache.find("b");
  EXPECT_NE(cache.find("a"), nullptr);
  cache.keep(calibration_run("c", 1));  // 1200 bytes with both: b was requested longest ago
  EXPECT_EQ(cache.find("b"), nullptr);
  EXPECT_NE(cache.find("a"), nullptr);
  EXPECT_EQ(held->config_id, "b");  // whoever has it keeps it
  EXPECT_EQ(cache.keep(calibration_run("large", 100))->config_id, "large");
  EXPECT_NE(cache.find("large"), nullptr);
  EXPECT_EQ(cache.find("a"), nullptr);
}

}  // namespace
}  // namespace bb::calibration_run_cache_test
