// Preconditioned conjugate gradients on an executor: matrix and vectors are there, the host reads one small struct for
// every 16 iterations.
#pragma once

#include <memory>

#include "core/linear/cg_runs.hpp"
#include "core/linear/executor/executor_preconditioner.hpp"

namespace bb::exec {

class ExecutorPcg final : CgRuns {
 public:
  /// Errors: OutOfMemory.
  ExecutorPcg(Executor& executor, Index n_vertices, std::unique_ptr<ExecutorPreconditioner> preconditioner);

  /// Solves A x = b up to |b - A x| <= tolerance |b| from x = 0, over the free degrees of freedom. fixed [n], b and
  /// x [3 n] are the executor's; x is 0 where degrees of freedom are fixed, b is not read there. All launches of an
  /// iteration are one graph, kept while pointers stay; the pattern may change in place. pattern_id: as in
  /// ExecutorPreconditioner::setup.
  /// Every way to fail has its status; the true residual decides (core/linear/cg_runs.hpp).
  LinearReport solve(const ExecutorMatrix& matrix, const FixedMask* fixed, const double* b, double* x,
                     double tolerance, int max_iterations, std::uint64_t pattern_id = 0);
  /// The same with the preconditioner of the last solve, whose matrix was positive definite.
  LinearReport solve_with_last(const ExecutorMatrix& matrix, const FixedMask* fixed, const double* b,
                               double* x, double tolerance, int max_iterations);
  /// The last direction of the iterations, [3 n]: after matrix_indefinite its curvature is negative.
  const Buffer<double>& direction() const { return p_; }
  /// |v| over the free degrees of freedom.
  double norm(const FixedMask* fixed, const double* v);
  ExecutorPreconditioner& preconditioner() { return *preconditioner_; }
  /// After a solve whose preconditioner had no factor: what of it, ExecutorPreconditioner::fault_text; else -1.
  Index fault() const { return fault_; }
  /// Launches one after another instead of graphs: for tests.
  void launch_plainly(bool plainly) { plain_ = plainly; }

 private:
  struct GraphKey {
    ExecutorMatrix matrix;
    PcgVectors vectors;
    int version;
    bool operator==(const GraphKey&) const = default;
  };

  LinearReport solve_prepared(const double* b, double tolerance, int max_iterations, double setup_s);
  void place(const ExecutorMatrix& matrix, const FixedMask* fixed, double* x);
  void set_residual(const double* from, const double* minus, double* r);
  void begin_run(bool first);
  void launch_iterations();
  void prepare_graph();
  CgRun run() override;
  double curvature_magnitude() override;
  double true_residual() override;
  void restart() override;
  double sum_of(const double* partial);
  LinearStatus judge_fault(LinearReport& report);

  Executor& executor_;
  std::unique_ptr<ExecutorPreconditioner> preconditioner_;
  Buffer<double> r_, z_, p_, q_, partial_;
  Buffer<PcgScalars> scalars_;
  Buffer<FactorFaults> faults_;
  PcgVectors v_{};
  ExecutorMatrix matrix_{};
  const double* b_ = nullptr;  // of the solve
  std::unique_ptr<LaunchGraph> graph_;
  GraphKey key_{};
  bool plain_ = false;
  Index fault_ = -1;
  PcgScalars host_{};  // as they were last read
};

}  // namespace bb::exec
