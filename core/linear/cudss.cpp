#include "core/linear/cudss.hpp"

#include "core/math/error.hpp"

namespace bb {
namespace {

CudssBackend& backend() {
  static CudssBackend one;
  return one;
}

}  // namespace

void set_cudss(CudssBackend given) { backend() = given; }

std::string missing_for(std::string_view solver) {
  if (solver != "cudss") return "";
  return backend().missing ? backend().missing() : "this program is linked without core/cudss";
}

void require_usable(const std::string& solver) {
  const std::string missing = missing_for(solver);
  if (!missing.empty()) {
    throw ConfigError("/linear_solver/name", '"' + solver + '"', "another solver: " + missing);
  }
}

LinearSolverEntry linear_solver_cudss() {
  LinearSolverEntry entry;
  entry.make = [](const ParameterMap&) {
    require_usable("cudss");
    return backend().make();
  };
  return entry;
}

}  // namespace bb
