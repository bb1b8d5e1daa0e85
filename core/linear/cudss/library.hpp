// The library cuDSS, opened at run time: the program starts without it. Its header is of the same major version.
#pragma once

#include <cudss.h>

#include <string>

namespace bb::cudss {

struct Library {
  std::string why;  // it cannot be used: the reason, and what to do; else empty
#define FUNCTION(name) decltype(&::name) name = nullptr;  // NOLINT(bugprone-macro-parentheses): a declaration
#include "core/linear/cudss/functions.inc"
#undef FUNCTION
};

/// Opens the file that BARRIERBENCH_CUDSS names, else libcudss.so of the major version of the header where the loader
/// finds it. It stays open. Errors: none; what fails is in `why`.
Library open_library();

/// "CUDSS_STATUS_ALLOC_FAILED (2)".
std::string status_text(cudssStatus_t status);

}  // namespace bb::cudss
