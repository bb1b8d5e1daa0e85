// What is required of a device before a run, and how it ends one.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "core/base/record/outcome.hpp"
#include "core/exec/executor.hpp"
#include "core/model/scene/scene.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// The executor of `/device`. Environment: BARRIERBENCH_DEVICE_MEMORY, bytes that buffers may take; and with device
/// host, for tests, BARRIERBENCH_FAIL_KERNEL=NAME:N, the launch of a kernel with NAME in its name that fails, from 1.
/// Errors: ConfigError for a malformed variable, and without a usable card.
std::unique_ptr<exec::Executor> make_executor(Device device);

/// Whether phases of a run on an executor wait for what they launched before they end (BARRIERBENCH_SYNCHRONIZE_PHASES=1), so that
/// each has the time of its own kernels; that costs time. Errors: ConfigError for another value.
bool synchronizes_phases();

/// Whether a kernel or a card can fail in it: a device, or a solver on a card.
bool can_lose_device(const RunConfig& config);

/// "NVIDIA H100, compute capability 9.0, driver of CUDA 13.0" where a card takes part in the run; none elsewhere.
std::optional<std::string> card_of(const RunConfig& config);

/// The kernel that the contact's shape brings, where the run is on a card. Errors: ConfigError without nvcc.
const DeviceCode* device_code_in(const RunConfig& config);

/// Whether everything that the config requests has a device form. Errors: ConfigError naming what has none.
void check_device_forms(const RunConfig& config, const Scene& scene);
/// The same, and whether the device is there. Errors: ConfigError with the reason.
void require_device(const RunConfig& config, const Scene& scene);

/// Outcomes after which a run on a device can only go on in another process.
constexpr bool stops_device(Outcome outcome) {
  return outcome == Outcome::oom || outcome == Outcome::kernel_failed;
}

/// A run on a device ended with such an outcome; its record is written.
struct DeviceStopped : std::runtime_error {
  DeviceStopped(Outcome why, const std::string& what) : std::runtime_error(what), outcome(why) {}
  Outcome outcome;
};

}  // namespace bb
