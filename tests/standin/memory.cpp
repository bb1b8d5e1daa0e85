// Device memory of the stand-in: the heap, with the size of the card and the direction of every copy checked.
#include <cstdlib>
#include <cstring>
#include <map>

#include "tests/standin/cudart.hpp"
#include "tests/standin/kernels.hpp"

namespace {
std::map<const char*, std::size_t>& allocations() {
  static std::map<const char*, std::size_t> all;
  return all;
}

/// What a copy between p [bytes] and another place is allowed to be, and do.
cudaError_t checked_copy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
  const bool to_device = kind == cudaMemcpyHostToDevice || kind == cudaMemcpyDeviceToDevice;
  const bool from_device = kind == cudaMemcpyDeviceToHost || kind == cudaMemcpyDeviceToDevice;
  if (kind == cudaMemcpyDefault || kind == cudaMemcpyHostToHost) return cudaErrorInvalidMemcpyDirection;
  if (standin::on_device(to, bytes) != to_device || standin::on_device(from, bytes) != from_device) {
    return cudaErrorInvalidValue;
  }
  return cudaSuccess;
}
}  // namespace

namespace standin {
bool on_device(const void* p, std::size_t bytes) {
  const char* at = static_cast<const char*>(p);
  auto after = allocations().upper_bound(at);
  if (after == allocations().begin()) return false;
  const auto& [begin, size] = *--after;
  return at + bytes <= begin + size;
}
}  // namespace standin

using namespace standin;

extern "C" {

cudaError_t cudaMalloc(void** p, size_t bytes) {
  if (capturing()) return spoil_capture();
  finish();
  *p = nullptr;
  if (bytes == 0) return result(cudaSuccess);
  if (bytes > settings().memory - counts().in_use) return result(cudaErrorMemoryAllocation);
  *p = std::malloc(bytes);
  memset(*p, 0xff, bytes);  // NaN: what a kernel reads before it was written shows
  allocations()[static_cast<char*>(*p)] = bytes;
  counts().in_use += bytes;
  add_kernel_memory(*p, bytes);
  return result(cudaSuccess);
}
cudaError_t cudaFree(void* p) {
  if (capturing()) return spoil_capture();
  finish();
  if (!p) return result(cudaSuccess);
  const auto found = allocations().find(static_cast<char*>(p));
  if (found == allocations().end()) return result(cudaErrorInvalidValue);
  counts().in_use -= found->second;
  allocations().erase(found);
  remove_kernel_memory(p);
  std::free(p);
  return result(cudaSuccess);
}
cudaError_t cudaMemGetInfo(size_t* free, size_t* total) {
  *total = settings().memory;
  *free = settings().memory - counts().in_use;
  return result(cudaSuccess);
}
cudaError_t cudaMemcpyAsync(void* to, const void* from, size_t bytes, cudaMemcpyKind kind,
                            cudaStream_t stream) {
  if (const cudaError_t code = checked_copy(to, from, bytes, kind); code != cudaSuccess) return result(code);
  return enqueue(stream, [=] {
    memmove(to, from, bytes);
    return cudaSuccess;
  });
}
cudaError_t cudaMemcpy(void* to, const void* from, size_t bytes, cudaMemcpyKind kind) {
  if (capturing()) return spoil_capture();
  const cudaError_t code = cudaMemcpyAsync(to, from, bytes, kind, nullptr);
  return code == cudaSuccess ? finish() : code;
}
cudaError_t cudaMemsetAsync(void* to, int byte, size_t bytes, cudaStream_t stream) {
  if (!on_device(to, bytes)) return result(cudaErrorInvalidValue);
  return enqueue(stream, [=] {
    memset(to, byte, bytes);
    return cudaSuccess;
  });
}

}  // extern "C"
