#include "core/exec/cuda/loaded_code.hpp"

#include <cuda_runtime_api.h>

#include <charconv>

#include "core/exec/executor.hpp"

namespace bb::cuda {
namespace {

using exec::ExecutionError;

/// Bytes of the second parameter of the entry, as PTX declares it: `.param .align 8 .b8 ENTRY_param_1[BYTES]`. 0: no such
/// entry.
std::size_t functor_bytes(const DeviceCode& code) {
  const std::string parameter = code.entry + "_param_1[";
  const std::size_t at = code.ptx.find(parameter);
  std::size_t bytes = 0;
  if (at == std::string::npos) return bytes;
  const char* digits = code.ptx.c_str() + at + parameter.size();
  std::from_chars(digits, code.ptx.c_str() + code.ptx.size(), bytes);
  return bytes;
}

void check_layout(const exec::KernelInfo& kernel) {
  const std::size_t bytes = functor_bytes(*kernel.code);
  if (bytes == 0) throw ExecutionError("PTX without a kernel " + kernel.code->entry);
  if (bytes == kernel.bytes) return;
  throw ExecutionError(kernel.code->entry + ": " + std::to_string(kernel.bytes) + " bytes on the host, " +
                       std::to_string(bytes) + " on the device");
}

}  // namespace

#if CUDART_VERSION >= 12080
namespace {

void check(cudaError_t code, const exec::KernelInfo& kernel, const char* call) {
  if (code == cudaSuccess) return;
  cudaGetLastError();  // it is reported here; no later call shall report it
  throw ExecutionError(kernel.code->entry + ": " + call + ": " + cudaGetErrorString(code) + " (CUDA error " +
                       std::to_string(code) + ")");
}

struct Loaded {
  cudaLibrary_t library = nullptr;
  DeviceKernel kernel{};

  Loaded() = default;
  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;
  ~Loaded() {
    if (library) cudaLibraryUnload(library);
  }
};

}  // namespace

std::shared_ptr<const DeviceKernel> load_code(const exec::KernelInfo& kernel) {
  check_layout(kernel);
  const auto loaded = std::make_shared<Loaded>();
  check(cudaLibraryLoadData(&loaded->library, kernel.code->ptx.c_str(), nullptr, nullptr, 0, nullptr, nullptr,
                            0),
        kernel, "cudaLibraryLoadData");
  cudaKernel_t found = nullptr;
  check(cudaLibraryGetKernel(&found, loaded->library, kernel.code->entry.c_str()), kernel,
        "cudaLibraryGetKernel");
  loaded->kernel = {static_cast<const void*>(found), kernel.bytes, kernel.blocks};
  return {loaded, &loaded->kernel};
}
#else
std::shared_ptr<const DeviceKernel> load_code(const exec::KernelInfo& kernel) {
  check_layout(kernel);
  throw ExecutionError(
      kernel.code->entry +
      ": device code that is made at run time is loaded by CUDA 12.8 or newer; this program was "
      "built with an older one");
}
#endif

}  // namespace bb::cuda
