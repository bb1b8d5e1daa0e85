// What the stand-in lets go wrong: no card, no memory, kernels that fail. Every message names what failed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "core/exec/cuda/copy_rates.hpp"
#include "core/exec/cuda/device.hpp"
#include "core/exec/cuda/device_executor.hpp"
#include "core/exec/cuda/kernel_table.hpp"
#include "core/math/error.hpp"
#include "tests/standin/cudart.hpp"
#include "tests/standin/device_kernels.hpp"
#include "tests/standin/messages.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::device_kernels {
void add_to(cuda::KernelTable& table);
}

namespace {

using namespace bb;
using namespace bb::exec;
using namespace bb::device_kernels;

class Standin : public testing::Test {
 protected:
  void SetUp() override {
    standin::reset();
    add_to(cuda::kernel_table());
  }
  void TearDown() override { standin::reset(); }
};

using test::expect_parts;
using test::message;

TEST_F(Standin, ProbeFindsTheCard) {
  const cuda::DeviceProbe probe = cuda::probe_device();
  EXPECT_TRUE(probe.usable) << probe.why;
  EXPECT_EQ(probe.card, "stand-in");
  EXPECT_EQ(probe.capability, 90);
  EXPECT_EQ(probe.memory, std::size_t{1} << 32);
  EXPECT_EQ(standin::counts().launches, 1);  // of the self-test
  EXPECT_EQ(standin::counts().in_use, 0u);
}

TEST_F(Standin, ProbeSaysWhyThereIsNoCard) {
  struct Case {
    std::function<void(standin::Settings&)> set;
    std::vector<std::string> says;
  };
  const Case cases[] = {
      {[](auto& s) { s.count_code = cudaErrorInsufficientDriver, s.driver = 0; }, {"no NVIDIA driver"}},
      {[](auto& s) { s.count_code = cudaErrorInsufficientDriver, s.driver = 11040; },
       {"too old", "11.4", "13.0"}},
      {[](auto& s) { s.count_code = cudaErrorNoDevice; }, {"no NVIDIA card"}},
      {[](auto& s) { s.count = 0; }, {"no NVIDIA card"}},
      {[](auto& s) { s.count_code = cudaErrorSystemNotReady; }, {"cudaGetDeviceCount", "802"}},
      {[](auto& s) { s.major = 7, s.minor = 5; }, {"stand-in", "7.5", "8.0"}},
      {[](auto& s) { s.wrong_numbers = true; }, {"wrong numbers"}},
      {[](auto& s) { s.refuse_launch = 0; }, {"self-test", "too many resources"}},
      {[](auto& s) { s.break_launch = 0; }, {"self-test", "illegal memory access"}},
      {[](auto& s) { s.memory = 8; }, {"cudaMalloc", "out of memory"}},
  };
  for (const Case& c : cases) {
    standin::reset();
    c.set(standin::settings());
    const cuda::DeviceProbe probe = cuda::probe_device();
    EXPECT_TRUE(probe.built);
    EXPECT_FALSE(probe.usable);
    expect_parts(probe.why, c.says);
    EXPECT_EQ(cudaGetLastError(), standin::broken());  // what was reported is not the error of a later launch
    standin::reset();
    c.set(standin::settings());
    expect_parts(message<ConfigError>([] { cuda::make_device_executor(); }), {"/device", probe.why});
  }
}

TEST_F(Standin, OutOfMemoryNamesTheBufferAndTheCard) {
  cuda::DeviceExecutor executor;
  standin::settings().memory = 1 << 20;
  Buffer<double> rows(executor, "contact rows", 1000);
  const std::string text =
      message<OutOfMemory>([&] { Buffer<double>(executor, "matrix values", Index{1} << 20); });
  expect_parts(text, {"matrix values", "8.00 MiB", "7.81 KiB", "1016.19 KiB of 1.00 MiB free on the card"});
  rows.fill_zero();  // the executor is as good as before
  executor.each(1000, Square{rows.data()});
  EXPECT_EQ(rows.get(999), 0);
}

TEST_F(Standin, LocalMemoryOfKernelsIsCountedOnceAndRefusedByName) {
  standin::settings().local_bytes = 1000;
  cuda::DeviceExecutor device;
  Buffer<double> x(device, "x", 256), y(device, "y", 2);
  x.fill_zero();
  for (int again = 0; again < 2; ++again) device.each(2, Square{x.data()});
  device.blocks(1, BlockSums{x.data(), y.data()});
  EXPECT_EQ(device.memory().by_name().at("local memory of kernels"), std::size_t{2} * 1024 * 1000);
  EXPECT_EQ(cuda::local_memory_of_kernels(), std::size_t{2} * 1024 * 1000);
  standin::settings().refuse_launch = standin::counts().launches;
  standin::settings().refuse_code = cudaErrorMemoryAllocation;
  const std::string said = message<OutOfMemory>([&] { device.each(2, Square{x.data()}); });
  expect_parts(said, {"local memory of kernels", "Square", "free on the card"});
}

TEST_F(Standin, AFailedLaunchNamesTheKernel) {
  cuda::DeviceExecutor executor;
  Buffer<double> x(executor, "x", 4);
  standin::settings().refuse_launch = standin::counts().launches;
  expect_parts(message<ExecutionError>([&] { executor.each(4, Square{x.data()}); }),
               {"bb::device_kernels::Square (4)", "too many resources", "701"});
}

TEST_F(Standin, AFailedKernelIsNamedWhereItsErrorIsSeen) {
  const std::function<void(cuda::DeviceExecutor&, Buffer<double>&)> seen_by[] = {
      [](auto& executor, auto&) { executor.synchronize(); }, [](auto&, auto& x) { x.get(0); },
      [](auto&, auto& x) { x.set(0, 1); }};
  for (const auto& see : seen_by) {
    standin::reset();
    cuda::DeviceExecutor executor;
    Buffer<double> x(executor, "x", 4);
    executor.each(4, OutOfBounds{x.data()});
    expect_parts(message<ExecutionError>([&] { see(executor, x); }),
                 {"illegal memory access", "700", "bb::device_kernels::OutOfBounds", "CUDA_LAUNCH_BLOCKING"});
    EXPECT_NE(standin::counts().fault, "");
    // Nothing works on the card from now on, and everything says so.
    EXPECT_THROW(executor.each(4, Square{x.data()}), ExecutionError);
  }
}

TEST_F(Standin, AnErrorWithinAGraphNamesItsKernels) {
  cuda::DeviceExecutor executor;
  Buffer<double> x(executor, "x", 4);
  executor.begin_capture();
  executor.each(4, Square{x.data()});
  executor.each(4, OutOfBounds{x.data()});
  const auto graph = executor.end_capture();
  executor.synchronize();
  executor.replay(*graph);
  expect_parts(message<ExecutionError>([&] { executor.synchronize(); }), {"Square", "OutOfBounds"});
}

TEST_F(Standin, AGraphWithoutAllItsKernelsIsRefused) {
  cuda::DeviceExecutor executor;
  Buffer<double> x(executor, "x", 4);
  standin::settings().forget_a_node = true;
  executor.begin_capture();
  executor.each(4, Square{x.data()});
  executor.each(4, Square{x.data()});
  expect_parts(message<ExecutionError>([&] { executor.end_capture(); }), {"1 nodes instead of 2"});
  EXPECT_EQ(standin::counts().graphs, 0);
}

TEST_F(Standin, WhatIsNotALaunchSpoilsACapture) {
  cuda::DeviceExecutor executor;
  Buffer<double> x(executor, "x", 4);
  executor.begin_capture();
  EXPECT_THROW(static_cast<void>(x.get(0)), ExecutionError);
  EXPECT_THROW(executor.end_capture(), ExecutionError);
}

TEST_F(Standin, CopiesInTheWrongDirectionAreErrors) {
  cuda::DeviceExecutor executor;
  Buffer<double> x(executor, "x", 4);
  double here[4] = {};
  EXPECT_THROW(executor.copy(x.data(), here, 8), ExecutionError);
  EXPECT_THROW(executor.upload(here, x.data(), 8), ExecutionError);
  EXPECT_THROW(executor.download(x.data(), here, 8), ExecutionError);
  EXPECT_THROW(executor.upload(x.data(), here, 40), ExecutionError);
  EXPECT_THROW(executor.fill_bytes(here, 0, 8), ExecutionError);
}

TEST_F(Standin, AGraphIsInstantiatedOnceAndMemoryIsGivenBack) {
  {
    cuda::DeviceExecutor executor;
    Buffer<double> x(executor, "x", 4);
    x.fill_zero();
    executor.begin_capture();
    executor.each(4, Square{x.data()});
    const auto graph = executor.end_capture();
    for (int i = 0; i < 5; ++i) executor.replay(*graph);
    const int waits = standin::counts().waits;
    executor.synchronize();
    EXPECT_EQ(waits + 1, standin::counts().waits);  // nothing waits between replays
    EXPECT_EQ(standin::counts().graphs, 1);
    EXPECT_EQ(standin::counts().replays, 5);
  }
  EXPECT_EQ(standin::counts().in_use, 0u);
}

TEST_F(Standin, TimesOfKernelsAreWrittenWhereTheEnvironmentSays) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "kernel_times.json";
  setenv("BARRIERBENCH_KERNEL_TIMES", file.c_str(), 1);
  for (const int launches : {3, 2}) {  // executors of one process
    const auto executor = cuda::make_device_executor();
    Buffer<double> x(*executor, "x", 4);
    x.fill_zero();
    for (int i = 0; i < launches; ++i) executor->each(4, Square{x.data()});
  }
  unsetenv("BARRIERBENCH_KERNEL_TIMES");
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  expect_parts(text, {"barrierbench.kernel_times/1",
                      R"("bb::device_kernels::Square": {"launches": 5, "seconds": 0.005)"});
}

TEST_F(Standin, CopiesAreMeasured) {
  cuda::DeviceExecutor executor;
  const cuda::CopyRates rates = cuda::measure_copies(executor, 1 << 20, 0);
  EXPECT_EQ(rates.bytes, std::size_t{1} << 20);
  for (const double rate : {rates.copy, rates.upload, rates.download}) EXPECT_GT(rate, 0);
}

}  // namespace
