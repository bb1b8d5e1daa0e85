// The iterative solver of the registry: conjugate gradients with a preconditioner by name.
#include <cmath>
#include <string>

#include "core/linear/conjugate_gradients.hpp"
#include "core/linear/forcing.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/linear/stopwatch.hpp"

namespace bb {
namespace {

class Pcg final : public LinearSolver {
 public:
  explicit Pcg(const ParameterMap& parameters)
      : forcing_(parameters),
        max_iterations_(integer(parameters, "max_iterations")),
        preconditioner_(make_preconditioner(text(parameters, "preconditioner"), parameters)) {}
  std::string_view name() const override { return "pcg"; }
  void begin_step() override { forcing_.begin_step(); }
  bool wants_mesh() const override { return preconditioner_->wants_mesh(); }
  void keep(Archive& archive) override { preconditioner_->keep(archive); }
  LinearReport solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) override;
  Definiteness examine(const ReducedSystem& a, const NearMatrix& near) override {
    set_up_ = false;
    return examine_preconditioned(a, near, *preconditioner_, max_iterations_, product_);
  }
  std::optional<Definiteness> examine_solved() override {
    if (!set_up_) return std::nullopt;
    return examine_by_gradients(product_, *preconditioner_, max_iterations_);
  }

 private:
  Forcing forcing_;
  int max_iterations_;
  std::unique_ptr<Preconditioner> preconditioner_;
  SymmetricProduct product_;
  bool set_up_ = false;  // product_ and preconditioner_ are those of the last solve
  ConjugateGradients cg_;
};

LinearReport Pcg::solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) {
  LinearReport report;
  report.iterative = true;
  const Stopwatch stopwatch;
  set_up_ = false;
  product_.update(system);
  const double b_norm = cg_.norm(b);
  if (!std::isfinite(b_norm) || !product_.all_finite()) {
    report.status = LinearStatus::non_finite;
  } else if (b_norm > 0) {
    report.status = preconditioner_->setup(system, product_);
    report.detail = preconditioner_->detail();
    report.preconditioner_shifts = preconditioner_->shifts();
    report.preconditioner_shift = preconditioner_->shift();
  }
  report.factor_s = stopwatch.seconds();
  if (b_norm == 0) return report;
  report.residual_true = report.residual_recurrence = 1;
  if (report.status != LinearStatus::ok) return report;
  set_up_ = true;

  report.tolerance = forcing_.tolerance(b_norm, right_side());
  report.status = cg_.solve(product_, *preconditioner_, b, report.tolerance, max_iterations_, x, report);
  report.solve_s = stopwatch.seconds() - report.factor_s;
  return report;
}

}  // namespace

LinearSolverEntry linear_solver_pcg() {
  LinearSolverEntry entry;
  entry.iterative = true;
  entry.parameters = Forcing::parameters();
  entry.parameters.push_back({"preconditioner", name_in([] { return preconditioners().names(); }),
                              "block_jacobi", "a registered preconditioner"});
  entry.parameters.push_back({"max_iterations", count(1, 1000000000), 10000, "cap on iterations of a solve"});
  entry.make = [](const ParameterMap& complete) -> std::unique_ptr<LinearSolver> {
    return std::make_unique<Pcg>(complete);
  };
  return entry;
}

}  // namespace bb
