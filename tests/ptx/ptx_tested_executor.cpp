// Of the tests of the modules with kernels as PTX: every launch runs on the host and as PTX, and both have to leave the same bits.
#include "tests/executor/tested_executor.hpp"
#include "tests/ptx/lockstep_executor.hpp"

namespace bb::test {

struct TestedExecutor::Device final : ptx::LockstepExecutor {
  Device(const TestedExecutor& of, exec::Order order, unsigned seed)
      : LockstepExecutor(order, seed), tested(of) {}
  using LockstepExecutor::allocate_bytes;
  using LockstepExecutor::release_bytes;
  using LockstepExecutor::run;
  const exec::MemoryLedger& names() const override { return tested.memory(); }

  const TestedExecutor& tested;
};

TestedExecutor::TestedExecutor() : TestedExecutor(exec::Order::forward) {}
TestedExecutor::TestedExecutor(exec::Order order, unsigned seed)
    : HostExecutor(order, seed), device_(std::make_unique<Device>(*this, order, seed)) {}
TestedExecutor::~TestedExecutor() = default;

void TestedExecutor::run(const exec::KernelInfo& kernel, exec::Index n, const void* f) {
  device_->run(kernel, n, f);
}
void* TestedExecutor::allocate_bytes(std::size_t bytes) { return device_->allocate_bytes(bytes); }
void TestedExecutor::release_bytes(void* memory) { device_->release_bytes(memory); }

}  // namespace bb::test
