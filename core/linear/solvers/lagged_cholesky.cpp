// Conjugate gradients preconditioned by the Cholesky factor of an earlier matrix of the same size: of another
// pattern too, since contacts come and go one by one and a few iterations make up for each. The present matrix
// is factorised when
//   - there is no factor: the first solve, another size, or the last factorisation failed,
//   - the earlier factor does not bring the residual down to the tolerance within max_pcg_iterations.
// Negative curvature beyond rounding proves that the matrix is indefinite, and is reported as such at once; the
// factor stays. A factorisation that fails is matrix_indefinite, as with cholmod.
#include <cmath>
#include <string>

#include "core/base/archive/archive.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/conjugate_gradients.hpp"
#include "core/linear/direct_solve.hpp"
#include "core/linear/forcing.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/linear/stopwatch.hpp"

namespace bb {
namespace {

void keep_matrix(Archive& archive, ReducedSystem& system) {
  auto& lower = system.lower;
  std::vector<int> start(lower.outerIndexPtr(), lower.outerIndexPtr() + lower.outerSize() + 1);
  std::vector<int> row(lower.innerIndexPtr(), lower.innerIndexPtr() + lower.nonZeros());
  std::vector<double> value(lower.valuePtr(), lower.valuePtr() + lower.nonZeros());
  archive(system.block_start, system.block_vertex, system.pattern_id, start, row, value);
  if (!archive.reads()) return;
  const auto n = static_cast<Eigen::Index>(start.size()) - 1;
  lower = Eigen::Map<const Eigen::SparseMatrix<double>>(n, n, static_cast<Eigen::Index>(value.size()),
                                                        start.data(), row.data(), value.data());
}

/// M = L L^T of the matrix that it factorised last, of which it has a copy.
class Factor final : public Preconditioner {
 public:
  LinearStatus factorize(const ReducedSystem& system) {
    const LinearStatus status = factor_.factorize(system);
    if (status == LinearStatus::ok) of_ = system;
    return status;
  }
  LinearStatus setup(const ReducedSystem& system, const SymmetricProduct&) override {
    return factorize(system);
  }
  /// The matrix; one that read it has to make the factor.
  void keep(Archive& archive) override {
    factor_.keep(archive);
    keep_matrix(archive, of_);
  }
  LinearStatus make() { return factor_.factorize(of_); }
  void solve(const VecXd& r, VecXd& z) const { factor_.solve(r, z); }
  void apply(const VecXd& r, VecXd& z) const override { solve(r, z); }
  const CholmodFactor& cholmod() const { return factor_; }

 private:
  mutable CholmodFactor factor_;  // a solve writes to its workspace
  ReducedSystem of_;
};

class LaggedCholesky final : public LinearSolver {
 public:
  explicit LaggedCholesky(const ParameterMap& parameters)
      : forcing_(parameters), max_pcg_iterations_(integer(parameters, "max_pcg_iterations")) {}
  std::string_view name() const override { return "lagged_cholesky"; }
  void begin_step() override { forcing_.begin_step(); }
  void keep(Archive& archive) override {
    archive(n_);
    bool there = n_ >= 0;
    archive(there);
    if (there) factor_.keep(archive);
    if (archive.reads()) to_make_ = there;
  }

  // The factor that is left, of A or of the near matrix, serves the solves to come.
  Definiteness examine(const ReducedSystem& a, const NearMatrix& near) override {
    Definiteness out = examine_directly(factor_, a, near);
    n_ = out.verdict == Definiteness::Verdict::unknown ? -1 : a.lower.rows();
    return out;
  }

  LinearReport solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) override {
    LinearReport report;
    report.iterative = true;
    const Stopwatch stopwatch;
    product_.update(system);
    const double b_norm = cg_.norm(b);
    if (!std::isfinite(b_norm) || !product_.all_finite()) {
      report.status = LinearStatus::non_finite;
      fail(x, report);
    } else if (b_norm > 0) {
      report.tolerance = forcing_.tolerance(b_norm, right_side());
      if (to_make_ && factor_.make() != LinearStatus::ok) n_ = -1;
      to_make_ = false;
      const bool settled = n_ == b.size() && iterate(b, max_pcg_iterations_, x, report);
      if (!settled && factorize(system, report)) iterate(b, fresh_iterations, x, report);
      if (report.status != LinearStatus::ok) fail(x, report);
    }
    report.solve_s = stopwatch.seconds() - report.analyze_s - report.factor_s;
    return report;
  }

 private:
  static constexpr int fresh_iterations = 100;  // one or two do it; more where the matrix is near singular

  // False when another factor may do better.
  bool iterate(const VecXd& b, int max_iterations, VecXd& x, LinearReport& report) {
    report.status =
        cg_.solve(product_, factor_, b, report.tolerance, report.iterations + max_iterations, x, report);
    return report.status == LinearStatus::ok || report.status == LinearStatus::matrix_indefinite;
  }

  bool factorize(const ReducedSystem& system, LinearReport& report) {
    report.status = factor_.setup(system, product_);
    report.factorized = report.status == LinearStatus::ok;
    report.detail = report.status == LinearStatus::matrix_indefinite ? factor_.cholmod().failure(system) : "";
    if (report.factorized) {
      report.factor_nnz = factor_.cholmod().factor_nonzeros();
      report.factor_flop = factor_.cholmod().factor_flops();
    }
    report.analyzed = factor_.cholmod().analyzed_last();
    report.analyze_s = factor_.cholmod().analyze_s();
    report.factor_s = factor_.cholmod().factor_s();
    n_ = report.factorized ? system.lower.rows() : -1;
    return report.factorized;
  }

  static void fail(VecXd& x, LinearReport& report) {
    report.residual_true = report.residual_recurrence = 1;
    x.setZero();
  }

  Forcing forcing_;
  int max_pcg_iterations_;
  Eigen::Index n_ = -1;   // size of the factor, -1 without one
  bool to_make_ = false;  // its matrix was read
  Factor factor_;
  SymmetricProduct product_;
  ConjugateGradients cg_;
};

}  // namespace

LinearSolverEntry linear_solver_lagged_cholesky() {
  LinearSolverEntry entry;
  entry.iterative = true;
  entry.parameters = Forcing::parameters();
  entry.parameters.push_back({"max_pcg_iterations", count(1, 1000000), 15,
                              "iterations with an earlier factor before the present matrix is factorised"});
  entry.make = [](const ParameterMap& complete) -> std::unique_ptr<LinearSolver> {
    return std::make_unique<LaggedCholesky>(complete);
  };
  return entry;
}

}  // namespace bb
