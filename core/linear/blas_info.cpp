#include "core/linear/blas_info.hpp"

#include <dlfcn.h>

#include <cstdlib>

extern "C" {
void openblas_set_num_threads(int n);
int openblas_get_num_threads(void);
int openblas_get_parallel(void);
char* openblas_get_config(void);
char* openblas_get_corename(void);
}

namespace bb {
namespace {

/// The file that the global symbol resolves to, which is the one CHOLMOD calls too.
std::string library_of(const char* symbol) {
  void* address = dlsym(RTLD_DEFAULT, symbol);
  Dl_info info{};
  if (address == nullptr || dladdr(address, &info) == 0 || info.dli_fname == nullptr) return "";
  return info.dli_fname;
}

bool is_openblas(const std::string& file) { return file.find("openblas") != std::string::npos; }

}  // namespace

void set_one_blas_thread() {
  openblas_set_num_threads(1);
  // CHOLMOD requests four threads of OpenMP explicitly, which only the nesting limit overrules. Looked up at run
  // time: a CHOLMOD without OpenMP needs none of it.
  using SetLevels = void (*)(int);
  static const auto set_levels =
      reinterpret_cast<SetLevels>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"));
  if (set_levels != nullptr) set_levels(0);
}

BlasInfo blas_info() {
  set_one_blas_thread();
  BlasInfo info;
  info.dgemm_library = library_of("dgemm_");
  info.dpotrf_library = library_of("dpotrf_");
  info.config = openblas_get_config();
  info.kernel = openblas_get_corename();
  const char* requested = std::getenv("OPENBLAS_CORETYPE");
  info.requested = requested != nullptr && *requested != '\0' ? requested : "native";
  const int parallel = openblas_get_parallel();  // 0, 1, 2 by OpenBLAS's documentation
  info.parallel = parallel == 0 ? "serial" : parallel == 1 ? "pthread" : "openmp";
  info.threads = openblas_get_num_threads();
  info.expected = is_openblas(info.dgemm_library) && is_openblas(info.dpotrf_library) && parallel != 2 &&
                  info.threads == 1;
  return info;
}

}  // namespace bb
