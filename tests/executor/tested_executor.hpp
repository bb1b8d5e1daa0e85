// The executor of the tests of the modules with kernels. Which one is decided when a test is linked, so that the cases are
// compiled once: test_ROOM_executor runs them on the host (host_tested_executor.cpp), test_ptx_ROOM also as nvcc's PTX
// (tests/ptx/ptx_tested_executor.cpp), test_card_ROOM also on a card (tests/card/card_tested_executor.cpp).
#pragma once

#include <memory>

#include "core/exec/host_executor.hpp"

namespace bb::test {

class TestedExecutor final : public exec::HostExecutor {
 public:
  TestedExecutor();
  explicit TestedExecutor(exec::Order order, unsigned seed = 1);
  ~TestedExecutor() override;

 protected:
  void run(const exec::KernelInfo& kernel, exec::Index n, const void* f) override;
  void* allocate_bytes(std::size_t bytes) override;
  void release_bytes(void* memory) override;

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace bb::test
