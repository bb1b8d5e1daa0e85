// What every fuzz target has: its input as text, and a check that ends the process so that libFuzzer keeps the input.
// A target may refuse its input with a ConfigError; any other exception, a failed check, a report of a sanitizer or
// an input that takes too long is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/math/error.hpp"

namespace bb::fuzz {

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Ends the process when `held` is false.
inline void require(bool held, const char* what) {
  if (held) return;
  std::fprintf(stderr, "fuzz target: %s\n", what);
  std::abort();
}

/// Runs f(); a ConfigError is a refusal and its message must name something.
template <class F>
int refused_or_read(F&& f) {
  try {
    f();
  } catch (const ConfigError& error) {
    require(!error.violations().empty(), "a refusal without a reason");
    for (const Violation& v : error.violations())
      require(!v.found.empty() && !v.allowed.empty(), "an empty reason");
  }
  return 0;
}

}  // namespace bb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
