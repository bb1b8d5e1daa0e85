#include "core/linear/blas_kernel.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "core/linear/blas_info.hpp"

namespace bb {
namespace {

/// OpenBLAS compares the names of its kernels so.
bool same_word(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

bool cpu_has_avx2_fma() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

}  // namespace

BlasKernelFacts blas_kernel_facts() {
  const BlasInfo info = blas_info();
  const char* environment = std::getenv("OPENBLAS_CORETYPE");
  return {info.kernel, environment != nullptr ? environment : "",
          info.config.find("DYNAMIC_ARCH") != std::string::npos, cpu_has_avx2_fma()};
}

BlasKernelChoice choose_blas_kernel(const std::optional<std::string>& request, const BlasKernelFacts& facts) {
  const bool named_elsewhere = !request && !facts.environment.empty();
  if (named_elsewhere || request == "native") return {};
  if (same_word(facts.running, fixed_blas_kernel)) return {};
  if (!facts.cpu_has_avx2_fma) return {BlasKernelAction::refuse, "the processor lacks AVX2 or FMA"};
  if (!facts.dynamic_arch) {
    return {BlasKernelAction::refuse, "this BLAS holds only the kernel " + facts.running +
                                          ": it is no OpenBLAS built with DYNAMIC_ARCH"};
  }
  if (same_word(facts.environment, fixed_blas_kernel)) {
    return {BlasKernelAction::refuse, "OPENBLAS_CORETYPE is " + facts.environment +
                                          ", and this OpenBLAS runs " + facts.running + " all the same"};
  }
  return {BlasKernelAction::restart, ""};
}

}  // namespace bb
