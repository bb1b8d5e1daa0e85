#include "core/cuda/device.hpp"

#include "core/cuda/device_executor.hpp"
#include "core/math/error.hpp"

namespace bb::cuda {

std::unique_ptr<exec::Executor> make_device_executor() {
  const DeviceProbe probe = probe_device();
  if (!probe.usable) throw ConfigError("/device", "\"cuda\"", "no card here: " + probe.why);
  return std::make_unique<DeviceExecutor>();
}

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

}  // namespace bb::cuda
