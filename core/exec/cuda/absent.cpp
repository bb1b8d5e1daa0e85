// device.hpp of a build without CUDA.
#include "core/exec/cuda/device.hpp"
#include "core/math/error.hpp"

namespace bb::cuda {

DeviceProbe probe_device() {
  DeviceProbe probe;
  probe.why = "this program was built without CUDA (" BB_CUDA_WHY ")";
  return probe;
}

std::unique_ptr<exec::Executor> make_device_executor() {
  throw ConfigError("/device", "\"cuda\"", "no card here: " + probe_device().why);
}

std::size_t local_memory_of_kernels() { return 0; }

}  // namespace bb::cuda
