// Launches of the stand-in: nvcc's registration shows which kernel a host stub stands for; the translated PTX runs.
#include "tests/standin/kernels.hpp"

#include <cstring>
#include <map>
#include <random>
#include <utility>

#include "tests/ptx/machine.hpp"
#include "tests/standin/cudart.hpp"

namespace {

// Registration runs before main, in any order.
std::map<const void*, std::string>& names() {
  static std::map<const void*, std::string> of_stub;
  return of_stub;
}
ptx::Machine& machine() {
  static ptx::Machine one;
  return one;
}

/// What cudaLibraryLoadData was given. Its kernel is that of a translated module with the same entry; the address of `entry`
/// is its handle.
struct Library {
  std::string text, entry;
};

struct Launch {
  const void* stub;
  const ptx::Kernel* kernel;
  unsigned blocks, threads;
  std::vector<unsigned char> parameters;
  int number;
};

struct Configuration {
  dim3 grid, block;
  std::size_t shared = 0;
  cudaStream_t stream = nullptr;
};
Configuration& pushed() {
  static Configuration one;
  return one;
}

cudaError_t run(const Launch& launch) {
  if (!names().contains(launch.stub)) {
    standin::counts().fault = "a kernel whose library was unloaded";
    return cudaErrorIllegalAddress;
  }
  if (standin::settings().wrong_numbers) return cudaSuccess;
  if (launch.number == standin::settings().break_launch) {
    standin::counts().fault = "a launch that the test broke";
    return cudaErrorIllegalAddress;
  }
  static std::mt19937_64 random(11);
  try {
    machine().launch(*launch.kernel, launch.parameters.data(), launch.parameters.size(), launch.blocks,
                     launch.threads, ptx::Order::shuffled, random);
  } catch (const ptx::Error& error) {
    standin::counts().fault = error.what();
    return cudaErrorIllegalAddress;
  }
  return cudaSuccess;
}

cudaError_t launch(const void* stub, dim3 grid, dim3 block, void** arguments, std::size_t shared,
                   cudaStream_t stream) {
  const auto name = names().find(stub);
  if (name == names().end()) return standin::result(cudaErrorInvalidDeviceFunction);
  const ptx::Kernel* kernel = ptx::find_kernel(name->second);
  if (!kernel) {
    standin::counts().fault = "no PTX of " + name->second;
    return standin::result(cudaErrorNoKernelImageForDevice);
  }
  const bool one_dimension = grid.y == 1 && grid.z == 1 && block.y == 1 && block.z == 1;
  if (!one_dimension || grid.x == 0 || grid.x > 0x7fffffffu || block.x == 0 || block.x > 1024 ||
      shared != 0) {
    return standin::result(cudaErrorInvalidConfiguration);
  }
  Launch out{stub,
             kernel,
             grid.x,
             block.x,
             std::vector<unsigned char>(kernel->param_bytes),
             standin::counts().launches++};
  if (out.number == standin::settings().refuse_launch)
    return standin::result(standin::settings().refuse_code);
  for (std::size_t i = 0; i < kernel->params.size(); ++i) {
    memcpy(out.parameters.data() + kernel->params[i].offset, arguments[i], kernel->params[i].bytes);
  }
  standin::counts().blocks = grid.x, standin::counts().threads = block.x;
  return standin::enqueue(stream, [out = std::move(out)] { return run(out); });
}

}  // namespace

namespace standin {
void add_kernel_memory(const void* p, std::size_t bytes) { machine().add_memory(p, bytes); }
void remove_kernel_memory(const void* p) { machine().remove_memory(p); }
}  // namespace standin

// What nvcc's host code calls.
extern "C" {

void** __cudaRegisterFatBinary(void*) {
  static void* handle = nullptr;
  return &handle;
}
void __cudaRegisterFatBinaryEnd(void**) {}
void __cudaUnregisterFatBinary(void**) {}
char __cudaInitModule(void**) { return 1; }
void __cudaRegisterFunction(void**, const char* stub, char*, const char* name, int, uint3*, uint3*, dim3*,
                            dim3*, int*) {
  names()[stub] = name;
}
void __cudaRegisterVar(void**, char*, char*, const char*, int, size_t, int, int) {}
unsigned __cudaPushCallConfiguration(dim3 grid, dim3 block, size_t shared, CUstream_st* stream) {
  pushed() = {grid, block, shared, stream};
  return 0;
}
cudaError_t __cudaPopCallConfiguration(dim3* grid, dim3* block, size_t* shared, void* stream) {
  *grid = pushed().grid, *block = pushed().block, *shared = pushed().shared;
  memcpy(stream, &pushed().stream, sizeof pushed().stream);
  return cudaSuccess;
}
// CUDA 12 launches by the stub, CUDA 13 by a handle that it requests: here the stub itself.
cudaError_t __cudaGetKernel(cudaKernel_t* kernel, const void* stub) {
  memcpy(kernel, &stub, sizeof stub);
  return cudaSuccess;
}
cudaError_t __cudaLaunchKernel(cudaKernel_t kernel, dim3 grid, dim3 block, void** arguments, size_t shared,
                               cudaStream_t stream) {
  return launch(reinterpret_cast<const void*>(kernel), grid, block, arguments, shared, stream);
}
cudaError_t cudaLaunchKernel(const void* stub, dim3 grid, dim3 block, void** arguments, size_t shared,
                             cudaStream_t stream) {
  return launch(stub, grid, block, arguments, shared, stream);
}

#if CUDART_VERSION >= 12080
// PTX that comes at run time. A card would compile it; here only its entries are looked for.
cudaError_t cudaLibraryLoadData(cudaLibrary_t* library, const void* code, cudaJitOption*, void**, unsigned,
                                cudaLibraryOption*, void**, unsigned) {
  if (standin::capturing()) return standin::spoil_capture();
  const std::string text = static_cast<const char*>(code);
  if (text.find(".version") == std::string::npos) return standin::result(cudaErrorInvalidPtx);
  *library = reinterpret_cast<cudaLibrary_t>(new Library{text, ""});
  ++standin::counts().libraries;
  return cudaSuccess;
}
cudaError_t cudaLibraryGetKernel(cudaKernel_t* kernel, cudaLibrary_t library, const char* name) {
  Library& loaded = *reinterpret_cast<Library*>(library);
  if (loaded.text.find(std::string(".entry ") + name + "(") == std::string::npos) {
    return standin::result(cudaErrorSymbolNotFound);
  }
  loaded.entry = name;
  names()[&loaded.entry] = name;
  *kernel = reinterpret_cast<cudaKernel_t>(&loaded.entry);
  return cudaSuccess;
}
cudaError_t cudaLibraryUnload(cudaLibrary_t library) {
  Library* loaded = reinterpret_cast<Library*>(library);
  names().erase(&loaded->entry);
  delete loaded;
  --standin::counts().libraries;
  return cudaSuccess;
}
#endif

}  // extern "C"
