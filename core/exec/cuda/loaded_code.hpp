// Device code that came after the program was built (core/math/device_code.hpp), loaded by the driver.
#pragma once

#include <memory>

#include "core/exec/cuda/kernel_table.hpp"
#include "core/exec/kernel_info.hpp"

namespace bb::cuda {

/// The kernel of kernel.code, for as long as the pointer lives; function is what launch() takes. Errors: ExecutionError with
/// the name of the entry: the driver refuses the PTX, it has no such entry, its functor has another size than the host's, or
/// the program was built with a CUDA before 12.8, which cannot load any.
std::shared_ptr<const DeviceKernel> load_code(const exec::KernelInfo& kernel);

}  // namespace bb::cuda
