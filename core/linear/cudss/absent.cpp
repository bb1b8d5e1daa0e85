// cudss.hpp of a build without CUDA or without cudss.h.
#include <stdexcept>

#include "core/exec/cuda/device.hpp"
#include "core/linear/cudss/cudss.hpp"

namespace bb::cudss {

std::string missing() {
  const cuda::DeviceProbe probe = cuda::probe_device();
  if (!probe.built) return probe.why;
  return "this program was built without cuDSS (cudss.h was not found): get the package nvidia-cudss-cu13, "
         "or "
         "-cu12, and configure with -DBB_CUDSS_ROOT=FOLDER, where FOLDER/include/cudss.h is";
}

std::unique_ptr<LinearSolver> make_solver() { throw std::logic_error(missing()); }

}  // namespace bb::cudss
