#include "tests/fuzz/mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return bb::fuzz::read_mesh_bytes(data, size, "fuzz.msh");
}
