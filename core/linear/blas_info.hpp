// Which BLAS the process really runs: for the record, and to refuse silent slowness.
#pragma once

#include <string>

namespace bb {

struct BlasInfo {
  std::string dgemm_library, dpotrf_library;  // files that the dynamic linker resolved the symbols to
  std::string config;                         // openblas_get_config()
  std::string kernel;                         // openblas_get_corename(): "Haswell", "SkylakeX", "Zen", ...
  std::string requested;                      // OPENBLAS_CORETYPE; "native" when it is not set
  std::string parallel;                       // "serial", "pthread", "openmp"
  int threads = 0;                            // of BLAS, after set_one_blas_thread
  /// dgemm and dpotrf come from OpenBLAS, serial or pthread variant, one thread. The openmp variant was five
  /// times slower on CHOLMOD's small blocks, reference BLAS twelve times.
  bool expected = false;
};

/// Sets one BLAS thread: two change the bits of a factor and were slower. Sets one OpenMP thread for what the
/// calling thread runs: CHOLMOD's own loops spin in their pool after every factorisation. Idempotent.
void set_one_blas_thread();
/// Calls set_one_blas_thread and reports. Cost: microseconds.
BlasInfo blas_info();

}  // namespace bb
