// The linear solver pcg_resident: the solver of the device backend on a matrix of the host, which goes up for every
// solve. It is there to be compared with pcg.
#include <cmath>

#include "core/exec/host_executor.hpp"
#include "core/linear/block_starts.hpp"
#include "core/linear/executor/executor_pcg.hpp"
#include "core/linear/executor/reduced_upload.hpp"
#include "core/linear/forcing.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {
namespace {

class PcgResident final : public LinearSolver {
 public:
  explicit PcgResident(const ParameterMap& parameters)
      : forcing_(parameters),
        max_iterations_(integer(parameters, "max_iterations")),
        parameters_(parameters),
        system_(executor_),
        b_(executor_, "right-hand side"),
        x_(executor_, "solution") {}
  std::string_view name() const override { return "pcg_resident"; }
  void begin_step() override { forcing_.begin_step(); }
  void keep(Archive& archive) override;
  LinearReport solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) override;

 private:
  void prepare(const ReducedSystem& system, const VecXd& b);

  Forcing forcing_;
  int max_iterations_;
  ParameterMap parameters_;
  exec::HostExecutor executor_;  // first: what follows lives in its memory
  exec::UploadedSystem system_;
  exec::Buffer<double> b_, x_;
  std::unique_ptr<exec::ExecutorPcg> pcg_;
  std::string kept_;  // of a preconditioner that is not made yet
  ChunkedDot dot_;
};

void PcgResident::keep(Archive& archive) {
  Archive apart;
  if (!archive.reads() && pcg_) pcg_->preconditioner().keep(apart);
  std::string bytes = !archive.reads() && pcg_ ? apart.bytes() : kept_;
  archive(bytes);
  if (!archive.reads()) return;
  kept_ = std::move(bytes);
  pcg_.reset();
}

void PcgResident::prepare(const ReducedSystem& system, const VecXd& b) {
  const exec::Index before = x_.size();
  system_.update(system);
  system_.upload(b, b_);
  x_.resize(3 * system_.n_vertices());
  if (!pcg_ || x_.size() != before) {
    auto preconditioner = exec::make_preconditioner(executor_, parameters_);
    if (!kept_.empty()) {
      Archive kept(std::move(kept_));
      preconditioner->keep(kept);
      kept_.clear();
    }
    pcg_ = std::make_unique<exec::ExecutorPcg>(executor_, system_.n_vertices(), std::move(preconditioner));
  }
}

LinearReport PcgResident::solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) {
  LinearReport report;
  report.iterative = true;
  prepare(system, b);
  const double b_norm = std::sqrt(dot_(b, b));
  if (!std::isfinite(b_norm) || !system_.all_finite()) {
    report.status = LinearStatus::non_finite;
    report.residual_true = report.residual_recurrence = 1;
    return report;
  }
  if (b_norm == 0) return report;
  report = pcg_->solve(system_.matrix(), system_.fixed(), b_.data(), x_.data(),
                       forcing_.tolerance(b_norm, right_side()), max_iterations_, system.pattern_id);
  system_.download(x_, x);
  const bool vertex = pcg_->fault() >= 0 && pcg_->fault() < system_.n_vertices();
  if (vertex && report.status == LinearStatus::preconditioner_indefinite) {
    const int dof = system.block_start[static_cast<std::size_t>(pcg_->fault())];
    report.detail = bad_diagonal_text(system, dof) + text(parameters_, "resident_preconditioner") +
                    " needs positive definite ones";
  }
  return report;
}

}  // namespace

LinearSolverEntry linear_solver_pcg_resident() {
  LinearSolverEntry entry;
  entry.iterative = true;
  entry.matrix = MatrixPlace::executor;
  entry.parameters = Forcing::parameters();
  for (Parameter& one : exec::preconditioner_parameters()) entry.parameters.push_back(std::move(one));
  entry.parameters.push_back({"max_iterations", count(1, 1000000000), 10000, "cap on iterations of a solve"});
  entry.make = [](const ParameterMap& complete) -> std::unique_ptr<LinearSolver> {
    return std::make_unique<PcgResident>(complete);
  };
  return entry;
}

}  // namespace bb
