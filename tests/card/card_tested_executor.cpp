// Of the tests of the modules with kernels on a card: every launch runs on the host and on the card, from the same memory, and
// both have to leave the same bits. A kernel that does not is a failure of the test, once, and the test goes on with the
// host's numbers, so that one run names them all.
#include <gtest/gtest.h>

#include "core/exec/cuda/device_executor.hpp"
#include "tests/card/launched.hpp"
#include "tests/card/mapped_memory.hpp"
#include "tests/executor/lockstep.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test {

std::map<std::string, Launched>& launched_kernels() {
  static std::map<std::string, Launched> kernels;
  return kernels;
}

namespace {
constexpr std::size_t gap = 256;  // between allocations, as cudaMalloc aligns
struct Card final : cuda::DeviceExecutor {
  using DeviceExecutor::launch;
};
}  // namespace

struct TestedExecutor::Device {
  Card card;
  Allocations memory;
};

TestedExecutor::TestedExecutor() : TestedExecutor(exec::Order::forward) {}
TestedExecutor::TestedExecutor(exec::Order order, unsigned seed)
    : HostExecutor(order, seed), device_(std::make_unique<Device>()) {}
TestedExecutor::~TestedExecutor() = default;

void TestedExecutor::run(const exec::KernelInfo& kernel, exec::Index n, const void* f) {
  const std::string name = kernel.name();
  Launched& count = launched_kernels()[name];
  const std::string found = difference(
      device_->memory, [&] { HostExecutor::run(kernel, n, f); },
      [&] {
        device_->card.launch(kernel, n, f);
        device_->card.synchronize();
      });
  ++count.launches, ++count.compared;
  if (!found.empty() && count.differences++ == 0) ADD_FAILURE() << name << ", n = " << n << ": " << found;
}

void* TestedExecutor::allocate_bytes(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  auto* all = static_cast<unsigned char*>(mapped_memory().allocate(bytes + 2 * gap, gap));
  std::fill_n(all, bytes + 2 * gap, static_cast<unsigned char>(0xff));
  device_->memory[all + gap] = bytes;
  return all + gap;
}

void TestedExecutor::release_bytes(void* memory) {
  if (!memory) return;
  const auto found = device_->memory.find(static_cast<unsigned char*>(memory));
  unsigned char* all = found->first - gap;
  const std::size_t bytes = found->second;
  for (std::size_t k = 0; k < gap; ++k) {
    EXPECT_TRUE(all[k] == 0xff && all[gap + bytes + k] == 0xff) << "written outside of " << bytes << " bytes";
  }
  device_->memory.erase(found);
  mapped_memory().deallocate(all, bytes + 2 * gap, gap);
}

}  // namespace bb::test
