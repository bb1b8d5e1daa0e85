// Which pilots a process keeps.
#include <gtest/gtest.h>

#include "experiments/run/pilot.hpp"

namespace bb::pilot_cache_test {
namespace {

TEST(PilotCache, KeepsWhatWasAskedForLastWithinItsBytes) {
  const auto pilot = [](const char* id, int states) {
    Pilot out;
    out.config_id = id;
    out.x.assign(static_cast<std::size_t>(states), Positions::Zero(3, 10));  // 240 bytes each
    return out;
  };
  PilotCache cache(1000);
  cache.keep(pilot("a", 2));
  cache.keep(pilot("b", 2));
  ASSERT_NE(cache.find("a"), nullptr);
  const auto held = cache.find("b");
  EXPECT_NE(cache.find("a"), nullptr);
  cache.keep(pilot("c", 1));  // 1200 bytes with both: b was not asked for longest
  EXPECT_EQ(cache.find("b"), nullptr);
  EXPECT_NE(cache.find("a"), nullptr);
  EXPECT_EQ(held->config_id, "b");  // whoever has it keeps it
  EXPECT_EQ(cache.keep(pilot("large", 100))->config_id, "large");
  EXPECT_NE(cache.find("large"), nullptr);
  EXPECT_EQ(cache.find("a"), nullptr);
}

}  // namespace
}  // namespace bb::pilot_cache_test
