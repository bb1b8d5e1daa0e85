#include <cuda_runtime_api.h>

#include "core/exec/cuda/device.hpp"
#include "core/exec/cuda/self_test.hpp"
#include "core/exec/cuda/table_entries.cuh"

namespace bb::cuda {
namespace {

constexpr int least_capability = 80;

std::string words(const char* call, cudaError_t code) {
  return std::string(call) + ": " + cudaGetErrorString(code) + " (CUDA error " + std::to_string(code) + ")";
}

/// Why the codes of the first call mean that there is nothing to use; empty where a card was counted.
std::string why_no_card(cudaError_t code, int count, const DeviceProbe& probe) {
  if (code == cudaErrorInsufficientDriver && probe.driver == 0) {
    return "no NVIDIA driver is loaded here (CUDA error 35), so no card can be used";
  }
  if (code == cudaErrorInsufficientDriver) {
    return "the NVIDIA driver is too old: it offers CUDA " + version_text(probe.driver) +
           ", this program needs the driver of CUDA " + version_text(probe.runtime);
  }
  if (code == cudaErrorNoDevice) return "no NVIDIA card was found (CUDA error 100)";
  if (code != cudaSuccess) return words("no card can be used: cudaGetDeviceCount", code);
  if (count == 0) return "no NVIDIA card was found";
  return "";
}

/// Runs the self-test. @return why the card cannot be used; empty where it gave the right answer
std::string run_self_test() {
  constexpr int n = 3;
  double got[n] = {};
  exec::Key least = ~exec::Key{0};
  SelfTest test{};
  std::string fault;
  const auto done = [&](const char* call, int code) {
    if (code != cudaSuccess && fault.empty()) fault = words(call, static_cast<cudaError_t>(code));
    return fault.empty();
  };
  if (done("cudaMalloc", cudaMalloc(&test.out, sizeof got)) &&
      done("cudaMalloc", cudaMalloc(&test.least, sizeof least)) &&
      done("cudaMemcpy", cudaMemcpy(test.least, &least, sizeof least, cudaMemcpyHostToDevice)) &&
      done("the kernel of the self-test",
           launch(each_kernel<SelfTest>(), &test, n, exec::block_threads, nullptr)) &&
      done("the kernel of the self-test", cudaDeviceSynchronize()) &&
      done("cudaMemcpy", cudaMemcpy(got, test.out, sizeof got, cudaMemcpyDeviceToHost))) {
    done("cudaMemcpy", cudaMemcpy(&least, test.least, sizeof least, cudaMemcpyDeviceToHost));
  }
  cudaFree(test.out);
  cudaFree(test.least);
  if (!fault.empty()) return fault;
  exec::Key expected_least = ~exec::Key{0};
  double expected[n] = {};
  const SelfTest here{expected, &expected_least};
  for (int i = 0; i < n; ++i) here(i);
  if (least == expected_least && memcmp(got, expected, sizeof got) == 0) return "";
  return "the card computed wrong numbers in the self-test (" + std::to_string(got[0]) + " instead of " +
         std::to_string(expected[0]) + ")";
}

std::string why_not(DeviceProbe& probe) {
  cudaDriverGetVersion(&probe.driver);
  cudaRuntimeGetVersion(&probe.runtime);
  int count = 0;
  const cudaError_t code = cudaGetDeviceCount(&count);
  if (const std::string why = why_no_card(code, count, probe); !why.empty()) return why;
  cudaDeviceProp card{};
  if (const cudaError_t asked = cudaGetDeviceProperties(&card, 0); asked != cudaSuccess) {
    return words("cudaGetDeviceProperties", asked);
  }
  probe.card = card.name;
  probe.capability = 10 * card.major + card.minor;
  if (probe.capability < least_capability) {
    return "the card " + probe.card + " has compute capability " + std::to_string(card.major) + "." +
           std::to_string(card.minor) + "; 8.0 or more is needed";
  }
  if (const cudaError_t asked = cudaMemGetInfo(&probe.free, &probe.memory); asked != cudaSuccess) {
    return words("cudaMemGetInfo", asked);
  }
  return run_self_test();
}

}  // namespace

DeviceProbe probe_device() {
  DeviceProbe probe;
  probe.built = true;
  probe.why = why_not(probe);
  probe.usable = probe.why.empty();
  cudaGetLastError();  // what failed here is reported; it is not the error of a later launch
  return probe;
}

}  // namespace bb::cuda
