#include "experiments/run/device_run.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <functional>
#include <string_view>

#include "barriers/shapes/registry.hpp"
#include "core/contact/executor/executor_barrier.hpp"
#include "core/contact/executor/given_shape.hpp"
#include "core/contact/executor/policy_kernels.hpp"
#include "core/exec/cuda/device.hpp"
#include "core/exec/host_executor.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "core/model/bodies/part.hpp"
#include "core/terms/executor/limit_forms.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

constexpr const char* memory_variable = "BARRIERBENCH_DEVICE_MEMORY";
constexpr const char* phases_variable = "BARRIERBENCH_SYNCHRONIZE_PHASES";
constexpr const char* failure_variable = "BARRIERBENCH_FAIL_KERNEL";

std::size_t positive(const char* variable, const std::string& text) {
  std::size_t out = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  if (error != std::errc() || stop != end || out == 0) throw ConfigError(variable, text, "an integer > 0");
  return out;
}

/// Bytes; 0 without a limit.
std::size_t memory_limit() {
  const char* const text = std::getenv(memory_variable);
  return text ? positive(memory_variable, text) : 0;
}

/// One launch of one kernel fails.
class FailingExecutor final : public exec::HostExecutor {
 public:
  FailingExecutor(std::string kernel, std::size_t launch) : kernel_(std::move(kernel)), left_(launch) {}

 private:
  void run(const exec::KernelInfo& kernel, exec::Index n, const void* f) override {
    if (kernel.name().find(kernel_) != std::string::npos && --left_ == 0) {
      throw exec::ExecutionError(kernel.name() + ": " + failure_variable + " requested this failure");
    }
    HostExecutor::run(kernel, n, f);
  }
  std::string kernel_;
  std::size_t left_;
};

std::unique_ptr<exec::Executor> make_host_executor() {
  const char* const text = std::getenv(failure_variable);
  if (!text) return std::make_unique<exec::HostExecutor>();
  const std::string asked = text;
  const std::size_t colon = asked.rfind(':');
  if (colon == std::string::npos || colon == 0) throw ConfigError(failure_variable, asked, "KERNEL:NUMBER");
  return std::make_unique<FailingExecutor>(asked.substr(0, colon),
                                           positive(failure_variable, asked.substr(colon + 1)));
}

/// Calls `check`, whose refusals know the setting and not the config that has it; section: a JSON pointer.
void at_config(const RunConfig& config, const std::string& section, const std::function<void()>& check) {
  try {
    check();
  } catch (const ConfigError& error) {
    std::vector<Violation> violations = error.violations();
    for (Violation& v : violations) {
      const std::string place = v.where.starts_with('/') ? v.where : section + "/" + v.where;
      v.where = config.source + "#" + place;
      v.allowed += "; or /device cpu";
    }
    throw ConfigError(std::move(violations));
  }
}

/// Numbers of its stiffness do not matter.
Method any_method(const RunConfig& config) {
  Calibration any;
  any.kappa = any.k_s = any.solid_k_s = 1;
  return make_method(config, any);
}

exec::ExecutorBarrier executor_barrier_of(const RunConfig& config, const Method& method) {
  return {method.contact, method.stiffness->has_potential(), config.device == Device::host};
}

bool solves_on_card(const RunConfig& config) {
  const LinearSolverEntry* solver = find_named(linear_solvers(), config.linear_solver.name);
  return solver && solver->matrix == MatrixPlace::card;
}

}  // namespace

std::unique_ptr<exec::Executor> make_executor(Device device) {
  std::unique_ptr<exec::Executor> out =
      device == Device::cuda ? cuda::make_device_executor() : make_host_executor();
  out->limit_memory(memory_limit());
  return out;
}

bool synchronizes_phases() {
  const char* const text = std::getenv(phases_variable);
  if (!text || std::string_view(text) == "0") return false;
  if (std::string_view(text) != "1") throw ConfigError(phases_variable, text, "0 or 1");
  return true;
}

bool can_lose_device(const RunConfig& config) {
  return config.device != Device::cpu || solves_on_card(config);
}

std::optional<std::string> card_of(const RunConfig& config) {
  if (config.device != Device::cuda && !solves_on_card(config)) return std::nullopt;
  const cuda::DeviceProbe probe = cuda::probe_device();
  if (!probe.usable) return std::nullopt;
  return fmt::format("{}, compute capability {}.{}, driver of CUDA {}", probe.card, probe.capability / 10,
                     probe.capability % 10, cuda::version_text(probe.driver));
}

const DeviceCode* device_code_in(const RunConfig& config) {
  if (config.device != Device::cuda) return nullptr;
  const Shape shape = require_shape(config.formulation.shape);
  return shape.device_code ? &shape.device_code(shape, exec::given_shape_layout) : nullptr;
}

void check_device_forms(const RunConfig& config, const Scene& scene) {
  if (config.device == Device::cpu) return;
  at_config(config, "/scene", [&] { require_kernels(part_entries(), scene, "/scene"); });
  const Method method = any_method(config);
  exec::require_kernel(*method.stiffness, config.source + "#/formulation/stiffness_policy/name");
  at_config(config, "/formulation", [&] { executor_barrier_of(config, method); });
  if (method.strain_limit && !(scene.limit.triangles.empty() && scene.solid_limit.tetrahedra.empty())) {
    at_config(config, "/strain_limit", [&] { exec::require_limit_kernels(method); });
  }
}

void require_device(const RunConfig& config, const Scene& scene) {
  if (config.device == Device::cpu) return;
  check_device_forms(config, scene);
  const std::unique_ptr<exec::Executor> executor = make_executor(config.device);
  at_config(config, "/formulation", [&] {
    try {
      executor_barrier_of(config, any_method(config)).prepare(*executor);
    } catch (const exec::ExecutionError& error) {
      throw ConfigError("shape", fmt::format("\"{}\" on a card: {}", config.formulation.shape, error.what()),
                        "a program built with CUDA 12.8 or newer, and a driver no older than the nvcc that "
                        "CUDACXX names; or /device host");
    }
  });
}

}  // namespace bb
