// The probe on the machine that the tests run on, with a card or without.
#include <gtest/gtest.h>

#include "core/exec/cuda/device.hpp"
#include "core/math/error.hpp"

namespace {

using namespace bb;

TEST(DeviceProbe, SaysWhatIsHere) {
  const cuda::DeviceProbe probe = cuda::probe_device();
  EXPECT_EQ(probe.built, probe.runtime >= 12000);
  EXPECT_EQ(probe.usable, probe.why.empty());
  if (probe.usable) {
    EXPECT_GE(probe.capability, 80);
    EXPECT_GT(probe.memory, 0u);
    EXPECT_EQ(cuda::make_device_executor()->name(), "cuda");
    return;
  }
  try {
    cuda::make_device_executor();
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find(probe.why), std::string::npos);
  }
}

TEST(DeviceProbe, WritesVersionsAsPeopleDo) {
  EXPECT_EQ(cuda::version_text(13000), "13.0");
  EXPECT_EQ(cuda::version_text(12080), "12.8");
}

}  // namespace
