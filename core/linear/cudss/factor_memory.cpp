#include "core/linear/cudss/factor_memory.hpp"

namespace bb::cudss {

constexpr const char* name = "cuDSS";

cudssDeviceMemHandler_t FactorMemory::handler() {
  cudssDeviceMemHandler_t out{this, &FactorMemory::allocate, &FactorMemory::release, {}};
  std::string_view("barrierbench").copy(out.name, CUDSS_ALLOCATOR_NAME_LEN - 1);
  return out;
}

int FactorMemory::allocate(void* self, void** memory, std::size_t bytes, cudaStream_t) {
  auto& own = *static_cast<FactorMemory*>(self);
  try {
    *memory = own.executor_.allocate(name, bytes);
    own.bytes_[*memory] = bytes;
    return 0;
  } catch (...) {
    own.error_ = std::current_exception();
    return 1;
  }
}

// cudaFree waits for the work before it, in every stream.
int FactorMemory::release(void* self, void* memory, std::size_t, cudaStream_t) {
  auto& own = *static_cast<FactorMemory*>(self);
  const auto found = own.bytes_.find(memory);
  if (found == own.bytes_.end()) return 1;
  own.executor_.release(name, memory, found->second);
  own.bytes_.erase(found);
  return 0;
}

}  // namespace bb::cudss
