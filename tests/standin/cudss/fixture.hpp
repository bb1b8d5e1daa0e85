// What every test on the stand-in for cuDSS begins and ends with.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/standin/cudart.hpp"
#include "tests/standin/cudss/state.hpp"

namespace bb {

class CudssStandin : public testing::Test {
 protected:
  void SetUp() override {
    standin::reset();
    standin::cudss() = {};
    setenv("BARRIERBENCH_CUDSS", BB_STANDIN_CUDSS, 1);
  }
  /// Nothing was called wrongly, and everything was given back.
  void TearDown() override {
    EXPECT_EQ(standin::cudss().fault, "");
    EXPECT_EQ(standin::cudss().objects, 0);
    EXPECT_EQ(standin::counts().in_use, 0u);
    EXPECT_EQ(standin::counts().fault, "");
  }
};

}  // namespace bb
