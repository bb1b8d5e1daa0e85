// Every barrier shape of the registry on the device against the host. A test of its own, since less of its code can run.
#include <gtest/gtest.h>

#include "tests/device_check/agreement.hpp"
#include "tests/device_check/shape_checks.hpp"

namespace {

using namespace bb::device_check;

TEST(DeviceCheck, Shapes) { expect_same_bits<EveryShape>(30); }
TEST(DeviceCheck, ShapesInFloat) { expect_same_bits<EveryShape, float>(30); }

}  // namespace
