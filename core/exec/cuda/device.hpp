// Is there a card that this build can use, and the executor on it. No CUDA header; without a CUDA compiler absent.cpp
// answers.
#pragma once

#include <memory>
#include <string>

#include "core/exec/executor.hpp"

namespace bb::cuda {

struct DeviceProbe {
  bool built = false;                // this program has device code
  bool usable = false;               // and a card ran it and gave the right answer
  std::string why;                   // not usable: the reason in words; else empty
  std::string card;                  // its name; empty where none was queried
  int capability = 0;                // 90: compute capability 9.0
  int driver = 0;                    // CUDA version of the driver, 13000: 13.0; 0: none
  int runtime = 0;                   // CUDA version of the run time that this program is linked with
  std::size_t memory = 0, free = 0;  // bytes of the card
};

/// Looks for the first card and runs one kernel on it. Errors: none; what fails is in `why`.
DeviceProbe probe_device();

/// With BARRIERBENCH_KERNEL_TIMES=FILE in the environment every launch is waited for and timed, and when an executor ends
/// the sums by kernel of all executors of the process so far are written to that file. Errors: ConfigError with the reason of the probe where no card is usable.
std::unique_ptr<exec::Executor> make_device_executor();

/// Bytes that a card keeps beside all buffers, once the kernel that needs the most local memory was launched. Requires that
/// the probe found it usable; 0 without device code.
std::size_t local_memory_of_kernels();

/// "13.0" of 13000.
std::string version_text(int version);

}  // namespace bb::cuda
