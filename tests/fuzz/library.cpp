// The headers of a plugin's file, before anything of it is loaded.
#include "core/model/plugin/library_file.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return bb::fuzz::refused_or_read(
      [&] { bb::check_library_bytes(bb::fuzz::text_of(data, size), "fuzz.so"); });
}
