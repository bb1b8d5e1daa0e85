#include "tests/ptx/ptx_executor.hpp"

#include "tests/ptx/report.hpp"

namespace ptx {

using bb::exec::Index;

PtxExecutor::PtxExecutor(bb::exec::Order order, unsigned seed) : HostExecutor(order, seed) {
  machine_.profile = profile_wanted();
}

void PtxExecutor::run(const bb::exec::KernelInfo& info, Index n, const void* f) {
  const Kernel* kernel = find_instance(info.blocks ? "run_blocks" : "run_each", info.name());
  if (!kernel) throw bb::exec::ExecutionError(info.name() + ": no PTX; its line in kernels.inc is missing");
  ++launches_;
  std::vector<unsigned char> params(kernel->param_bytes);
  const auto& where = kernel->params.back();  // the functor; before it the number of items
  if (where.bytes != info.bytes) {
    throw bb::exec::ExecutionError(info.name() + ": " + std::to_string(info.bytes) + " bytes on the host, " +
                                   std::to_string(where.bytes) + " on the device");
  }
  if (!info.blocks) memcpy(params.data(), &n, sizeof n);
  memcpy(params.data() + where.offset, f, info.bytes);
  const Index blocks = info.blocks ? n : (n + bb::exec::block_threads - 1) / bb::exec::block_threads;
  const Order by = order() == bb::exec::Order::reverse    ? Order::reverse
                   : order() == bb::exec::Order::shuffled ? Order::shuffled
                                                          : Order::forward;
  try {
    machine_.launch(*kernel, params.data(), params.size(), static_cast<std::uint32_t>(blocks),
                    bb::exec::block_threads, by, random());
  } catch (const Error& error) {
    throw bb::exec::ExecutionError(error.what());
  }
  if (machine_.profile) note_traffic(machine_);
}

// A gap before and after, so that no allocation ends where another begins. The word before the allocation says where
// the gap begins.
namespace {
constexpr std::size_t gap = 256;  // as cudaMalloc aligns
}
// The ledger has the buffer already, the executor does not.
std::string PtxExecutor::new_name() const {
  std::map<std::string, std::size_t> held;
  for (const auto& [begin, name] : names_) held[name] += allocations_.at(begin);
  for (const auto& [name, bytes] : names().by_name()) {
    if (bytes > held[name]) return name;
  }
  return "";
}
void* PtxExecutor::allocate_bytes(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  auto* all = static_cast<unsigned char*>(HostExecutor::allocate_bytes(bytes + 2 * gap));
  if (!all) return nullptr;
  unsigned char* memory = all + gap - reinterpret_cast<std::uintptr_t>(all) % gap;
  memcpy(memory - sizeof all, &all, sizeof all);
  const std::string name = new_name();
  machine_.add_memory(memory, bytes, name);
  allocations_[memory] = bytes, names_[memory] = name;
  return memory;
}
void PtxExecutor::release_bytes(void* memory) {
  if (!memory) return;
  machine_.remove_memory(memory);
  allocations_.erase(static_cast<unsigned char*>(memory)), names_.erase(static_cast<unsigned char*>(memory));
  void* all;
  memcpy(&all, static_cast<unsigned char*>(memory) - sizeof all, sizeof all);
  HostExecutor::release_bytes(all);
}

}  // namespace ptx
