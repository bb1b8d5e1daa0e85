// The direct solver of the registry: a CholmodFactor with its report.
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/direct_solve.hpp"
#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {
namespace {

class Cholmod final : public LinearSolver {
 public:
  std::string_view name() const override { return "cholmod"; }
  void keep(Archive& archive) override { factor_.keep(archive); }

  LinearReport solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) override {
    return solve_directly(factor_, system, b, x, residual_);
  }
  Definiteness examine(const ReducedSystem& a, const NearMatrix& near) override {
    return examine_directly(factor_, a, near);
  }

 private:
  CholmodFactor factor_;
  VecXd residual_;
};

}  // namespace

LinearSolverEntry linear_solver_cholmod() {
  LinearSolverEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<LinearSolver> {
    return std::make_unique<Cholmod>();
  };
  return entry;
}

}  // namespace bb
