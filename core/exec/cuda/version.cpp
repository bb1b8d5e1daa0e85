#include "core/exec/cuda/device.hpp"

namespace bb::cuda {

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

}  // namespace bb::cuda
