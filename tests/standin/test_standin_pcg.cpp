// The conjugate gradients of the device backend through the compiled device executor: the bits of the host executor, graphs and all.
#include <gtest/gtest.h>

#include "core/exec/cuda/device_executor.hpp"
#include "core/linear/executor/block_jacobi.hpp"
#include "tests/linear/executor/linear_cases.hpp"
#include "tests/standin/cudart.hpp"

namespace bb::exec {
namespace {

struct Solved {
  LinearReport report;
  std::vector<double> x;
};

Solved solve(Executor& executor, bool plainly, const ReducedSystem& system, const VecXd& b) {
  const int n_vertices = static_cast<int>(system.lower.rows()) / 3;
  const OwnedSystem owned(executor, system, some_fixed(n_vertices), true);
  Buffer<double> rhs(executor, "b"), x(executor, "x", 3 * owned.n());
  rhs.upload(plain(b));
  ExecutorPcg pcg(executor, owned.n(), std::make_unique<BlockJacobi>(executor));
  pcg.launch_plainly(plainly);
  Solved out;
  out.report = pcg.solve(owned.matrix(), owned.fixed.data(), rhs.data(), x.data(), 1e-11, 1000);
  out.x = x.download();
  return out;
}

TEST(StandinPcg, HasTheBitsOfTheHost) {
  standin::reset();
  const ReducedSystem system = grid_system(12, 0.3, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  HostExecutor host;
  const Solved here = solve(host, false, system, b);
  ASSERT_EQ(here.report.status, LinearStatus::ok) << here.report.detail;
  ASSERT_GT(here.report.iterations, 16);  // more than a graph
  for (const bool plainly : {false, true}) {
    cuda::DeviceExecutor device;
    const Solved there = solve(device, plainly, system, b);
    EXPECT_EQ(there.report.status, here.report.status) << there.report.detail << standin::counts().fault;
    EXPECT_EQ(there.report.iterations, here.report.iterations);
    EXPECT_EQ(there.report.residual_true, here.report.residual_true);
    EXPECT_EQ(there.x, here.x);
    EXPECT_EQ(standin::counts().graphs, 1);  // of the first
  }
  EXPECT_GT(standin::counts().replays, 1);
  EXPECT_GT(standin::counts().launches, 20);
  EXPECT_EQ(standin::counts().in_use, 0u);
}

// Three fits of memory: a scalar, a vector, nothing of a matrix.
TEST(StandinPcg, OutOfMemoryNamesABuffer) {
  const ReducedSystem system = grid_system(12, 0.3, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  for (const std::size_t memory : {std::size_t{2000}, std::size_t{40000}}) {
    standin::reset();
    standin::settings().memory = memory;
    try {
      cuda::DeviceExecutor device;
      solve(device, false, system, b);
      FAIL();
    } catch (const OutOfMemory& error) {
      EXPECT_NE(std::string(error.what()).find("free on the card"), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find("no memory for :"), std::string::npos) << error.what();
    }
    EXPECT_EQ(standin::counts().in_use, 0u);
  }
  standin::reset();
}

// Whichever launch fails, an error comes with a kernel's name and all memory is given back.
TEST(StandinPcg, EveryLaunchMayFail) {
  const ReducedSystem system = grid_system(4, 0.3, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  for (int broken = 0; broken < 40; broken += 3) {
    standin::reset();
    standin::settings().break_launch = broken;
    try {
      cuda::DeviceExecutor device;
      solve(device, true, system, b);
      ADD_FAILURE() << broken;
    } catch (const ExecutionError& error) {
      EXPECT_NE(std::string(error.what()).find("bb::exec::"), std::string::npos) << error.what();
    }
    EXPECT_EQ(standin::counts().in_use, 0u);
  }
  standin::reset();
}

}  // namespace
}  // namespace bb::exec
