// The switch that gives every x86-64-v3 machine the same factor, bit for bit. OpenBLAS picks its kernel by
// the processor, and each kernel adds in another order.
#pragma once

#include <optional>
#include <string>

namespace bb {

/// The kernel that every processor with AVX2 and FMA can run: OpenBLAS's word for it.
inline constexpr const char* fixed_blas_kernel = "Haswell";

struct BlasKernelFacts {
  std::string running;        // openblas_get_corename()
  std::string environment;    // OPENBLAS_CORETYPE, empty when not set
  bool dynamic_arch = false;  // the library holds the kernels of many processors
  bool cpu_has_avx2_fma = false;
};
/// Of this process.
BlasKernelFacts blas_kernel_facts();

enum class BlasKernelAction {
  keep,     // the process already runs what is wanted
  restart,  // with OPENBLAS_CORETYPE = Haswell: OpenBLAS reads it only while it is loaded
  refuse    // this machine or this library cannot; `reason` says why
};
struct BlasKernelChoice {
  BlasKernelAction action = BlasKernelAction::keep;
  std::string reason;  // of refuse
};

/// @param request  "haswell", "native", or nothing: what OPENBLAS_CORETYPE names if it is set, else haswell
/// Pure. Never restarts twice: with OPENBLAS_CORETYPE = Haswell and another kernel it refuses.
BlasKernelChoice choose_blas_kernel(const std::optional<std::string>& request, const BlasKernelFacts& facts);

}  // namespace bb
