// What this build reports of the linear solver cudss on this machine, with CUDA's own run time.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/exec/cuda/device.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

std::string refusal() {
  try {
    require_usable("cudss");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(CudssMissing, SaysWhatIsMissingAndWhatToDo) {
  setenv("BARRIERBENCH_CUDSS", "/nowhere/libcudss.so", 1);
  const std::string said = refusal();
  EXPECT_EQ(said.find("/linear_solver/name: found \"cudss\"; allowed: another solver: "), 0U) << said;
  const char* part = !cuda::probe_device().built ? "built without CUDA"
                     : BB_CUDSS_HEADER           ? "/nowhere/libcudss.so"
                                                 : "-DBB_CUDSS_ROOT=";
  EXPECT_NE(said.find(part), std::string::npos) << said;
}

TEST(CudssMissing, TheStandInNeedsTheHeader) {
  if (!BB_CUDSS_HEADER) {
    GTEST_SKIP() << "no cudss.h in this build (-DBB_CUDSS_ROOT=FOLDER): test_cudss_standin was not built";
  }
}

}  // namespace
}  // namespace bb
