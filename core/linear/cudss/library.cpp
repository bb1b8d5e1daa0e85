#include "core/linear/cudss/library.hpp"

#include <dlfcn.h>

#include <cstdlib>

namespace bb::cudss {
namespace {

constexpr const char* variable = "BARRIERBENCH_CUDSS";

std::string library_name() {
  const char* given = std::getenv(variable);
  return given && *given ? given : "libcudss.so." + std::to_string(CUDSS_VERSION_MAJOR);
}

/// Why the version cannot be used; empty where it can.
std::string why_not_version(const Library& library) {
  int major = 0;
  const cudssStatus_t status = library.cudssGetProperty(MAJOR_VERSION, &major);
  if (status != CUDSS_STATUS_SUCCESS) return "cudssGetProperty: " + status_text(status);
  if (major == CUDSS_VERSION_MAJOR) return "";
  return "it is of version " + std::to_string(major) + ", and the cudss.h of this build of version " +
         std::to_string(CUDSS_VERSION_MAJOR);
}

/// Why the file cannot be used; empty where it can.
std::string load(const std::string& name, Library& library) {
  void* file = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!file) return dlerror();
#define FUNCTION(function)                                                                 \
  library.function = reinterpret_cast<decltype(library.function)>(dlsym(file, #function)); \
  if (!library.function) return "it has no function " #function;
#include "core/linear/cudss/functions.inc"
#undef FUNCTION
  return why_not_version(library);
}

}  // namespace

Library open_library() {
  Library library;
  const std::string name = library_name(), why = load(name, library);
  if (!why.empty()) {
    library.why = "the library cuDSS (" + name + ") cannot be used: " + why + "; " + variable +
                  " in the environment names its file, LD_LIBRARY_PATH the folders of the libraries it needs";
  }
  return library;
}

std::string status_text(cudssStatus_t status) {
  const char* name = "an unknown status";
  switch (status) {
#define STATUS(value) \
  case value:         \
    name = #value;    \
    break;
    STATUS(CUDSS_STATUS_SUCCESS)
    STATUS(CUDSS_STATUS_NOT_INITIALIZED)
    STATUS(CUDSS_STATUS_ALLOC_FAILED)
    STATUS(CUDSS_STATUS_INVALID_VALUE)
    STATUS(CUDSS_STATUS_NOT_SUPPORTED)
    STATUS(CUDSS_STATUS_EXECUTION_FAILED)
    STATUS(CUDSS_STATUS_INTERNAL_ERROR)
    STATUS(CUDSS_STATUS_IR_FAILED)
#undef STATUS
  }
  return std::string(name) + " (" + std::to_string(static_cast<int>(status)) + ")";
}

}  // namespace bb::cudss
