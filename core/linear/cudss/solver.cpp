// The linear solver cudss: a cuDSS factor with its report.
#include "core/exec/cuda/device.hpp"
#include "core/linear/cudss/cudss.hpp"
#include "core/linear/cudss/factor.hpp"
#include "core/linear/direct_solve.hpp"

namespace bb::cudss {
namespace {

class Cudss final : public LinearSolver {
 public:
  std::string_view name() const override { return "cudss"; }

  LinearReport solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) override {
    return solve_directly(factor_, system, b, x, residual_);
  }
  Definiteness examine(const ReducedSystem& a, const NearMatrix& near) override {
    return examine_directly(factor_, a, near);
  }

 private:
  Factor factor_{open_library()};
  VecXd residual_;
};

}  // namespace

std::string missing() {
  const std::string why = open_library().why;
  if (!why.empty()) return why;
  const cuda::DeviceProbe probe = cuda::probe_device();
  return probe.usable ? "" : "no card here: " + probe.why;
}

std::unique_ptr<LinearSolver> make_solver() { return std::make_unique<Cudss>(); }

}  // namespace bb::cudss
