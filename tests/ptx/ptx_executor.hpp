// An executor whose launches run nvcc's PTX of the kernel, on the CPU: what only the device's compiler does to a kernel
// shows here, and what a kernel must not do there is an error here. Sort and scan are the host's.
#pragma once

#include "core/exec/host_executor.hpp"
#include "tests/ptx/machine.hpp"

namespace ptx {

class PtxExecutor : public bb::exec::HostExecutor {
 public:
  /// threads is forward here.
  explicit PtxExecutor(bb::exec::Order order = bb::exec::Order::forward, unsigned seed = 1);
  std::string_view name() const override { return "ptx"; }
  Machine& machine() { return machine_; }
  /// Launches so far.
  std::size_t launches() const { return launches_; }

 protected:
  /// Errors: bb::exec::ExecutionError where the kernel has no PTX or breaks a rule.
  void run(const bb::exec::KernelInfo& kernel, bb::exec::Index n, const void* f) override;
  void* allocate_bytes(std::size_t bytes) override;
  void release_bytes(void* memory) override;
  /// What says how allocations are named.
  virtual const bb::exec::MemoryLedger& names() const { return memory(); }
  /// Begin and bytes of all that is allocated.
  const std::map<unsigned char*, std::size_t>& allocations() const { return allocations_; }

 private:
  std::string new_name() const;

  Machine machine_;
  std::map<unsigned char*, std::size_t> allocations_;
  std::map<unsigned char*, std::string> names_;
  std::size_t launches_ = 0;
};

}  // namespace ptx
