#include "core/linear/executor/executor_pcg.hpp"

#include <algorithm>
#include <cmath>

#include "core/linear/executor/pcg_kernels.hpp"
#include "core/linear/solve_detail.hpp"
#include "core/linear/stopwatch.hpp"

namespace bb::exec {

ExecutorPcg::ExecutorPcg(Executor& executor, Index n_vertices,
                         std::unique_ptr<ExecutorPreconditioner> preconditioner)
    : executor_(executor),
      preconditioner_(std::move(preconditioner)),
      r_(executor, "pcg residual", 3 * n_vertices),
      z_(executor, "pcg preconditioned residual", 3 * n_vertices),
      p_(executor, "pcg direction", 3 * n_vertices),
      q_(executor, "pcg product", 3 * n_vertices),
      partial_(executor, "pcg partial sums"),
      scalars_(executor, "pcg scalars", 1),
      faults_(executor, "pcg factor faults", 1) {
  v_.partition = Partition::of(n_vertices);
  const Index n_blocks = v_.partition.n_blocks();
  partial_.resize(3 * n_blocks);
  v_.r = r_.data(), v_.z = z_.data(), v_.p = p_.data(), v_.q = q_.data();
  v_.partial_pq = partial_.data();
  v_.partial_rz = partial_.data() + n_blocks, v_.partial_rr = partial_.data() + 2 * n_blocks;
  v_.scalars = scalars_.data();
}

void ExecutorPcg::set_residual(const double* from, const double* minus, double* r) {
  executor_.blocks(v_.partition.n_blocks(),
                   SetResidual{v_.partition, v_.fixed, from, minus, r, v_.partial_rr});
}

double ExecutorPcg::sum_of(const double* partial) {
  executor_.blocks(1, FinishSum{partial, v_.partition.n_blocks(), v_.scalars});
  if (executor_.counts_only()) return 1;
  double sum = 0;
  executor_.download(&sum, &v_.scalars->sum, sizeof(sum));
  return sum;
}

double ExecutorPcg::norm(const FixedMask* fixed, const double* v) {
  v_.fixed = fixed;
  set_residual(v, nullptr, v_.q);
  return std::sqrt(sum_of(v_.partial_rr));
}

double ExecutorPcg::true_residual() {
  executor_.blocks(v_.partition.n_blocks(),
                   MultiplyDot{v_.partition, matrix_, v_.fixed, v_.x, v_.q, v_.partial_pq, nullptr});
  set_residual(b_, v_.q, v_.q);
  return std::sqrt(sum_of(v_.partial_rr));
}

double ExecutorPcg::curvature_magnitude() {
  executor_.blocks(v_.partition.n_blocks(), MagnitudeDot{v_.partition, matrix_, v_.p, v_.partial_pq});
  return sum_of(v_.partial_pq);
}

void ExecutorPcg::restart() {
  set_residual(v_.q, nullptr, v_.r);
  begin_run(false);
}

// r is set.
void ExecutorPcg::begin_run(bool first) {
  preconditioner_->apply(v_);
  executor_.copy(v_.p, v_.z, static_cast<std::size_t>(p_.size()) * sizeof(double));
  executor_.blocks(
      1, BeginRun{v_.partial_rz, v_.partial_rr, v_.partition.n_blocks(), faults_.data(), v_.scalars, first});
}

void ExecutorPcg::launch_iterations() {
  const Index n_blocks = v_.partition.n_blocks();
  for (int k = 0; k < graph_iterations; ++k) {
    executor_.blocks(n_blocks, MultiplyDot{v_.partition, matrix_, v_.fixed, v_.p, v_.q, v_.partial_pq,
                                           v_.scalars->state + k % 2});
    preconditioner_->update(v_, k);
    executor_.blocks(n_blocks,
                     StepDirection{v_.partition, v_.partial_rz, v_.partial_rr, v_.z, v_.p, v_.scalars, k});
  }
}

void ExecutorPcg::prepare_graph() {
  const GraphKey key{matrix_, v_, preconditioner_->version()};
  if (graph_ && key == key_) return;
  key_ = key;
  graph_.reset();
  executor_.begin_capture();
  try {
    launch_iterations();
  } catch (...) {
    try {
      executor_.end_capture();
    } catch (const ExecutionError&) {  // the first error reports more
    }
    throw;
  }
  graph_ = executor_.end_capture();
}

CgRun ExecutorPcg::run() {
  alpha_.clear(), beta_.clear();
  do {
    const int before = host_.state[0].iteration;
    if (plain_) {
      launch_iterations();
    } else {
      executor_.replay(*graph_);
    }
    host_ = scalars_.get(0);
    const int done = host_.state[0].iteration - before;
    alpha_.insert(alpha_.end(), host_.alpha, host_.alpha + done);
    beta_.insert(beta_.end(), host_.beta, host_.beta + done);
  } while (host_.state[0].running());
  return {host_.state[0], host_.goal, host_.curvature};
}

// What of the preconditioner has no factor.
LinearStatus ExecutorPcg::judge_fault(LinearReport& report) {
  const FactorFaults faults = faults_.get(0);
  const Key worst = std::min({faults.non_finite, faults.indefinite});
  fault_ = static_cast<Index>(worst != no_fault ? worst : faults.singular);
  report.detail = "the diagonal block of " + preconditioner_->fault_text(fault_);
  if (worst == no_fault) {
    report.detail += " is 0 or singular";
    return LinearStatus::preconditioner_indefinite;
  }
  report.detail += worst == faults.non_finite ? " is not finite" : " is not positive definite";
  return worst == faults.non_finite ? LinearStatus::non_finite : LinearStatus::matrix_indefinite;
}

void ExecutorPcg::place(const ExecutorMatrix& matrix, const FixedMask* fixed, double* x) {
  matrix_ = matrix;
  v_.fixed = fixed, v_.x = x;
}

LinearReport ExecutorPcg::solve(const ExecutorMatrix& matrix, const FixedMask* fixed, const double* b,
                                double* x, double tolerance, int max_iterations, std::uint64_t pattern_id) {
  const Stopwatch stopwatch;
  place(matrix, fixed, x);
  fault_ = -1;
  faults_.set(0, {no_fault, no_fault, no_fault});
  preconditioner_->setup(matrix_, v_, pattern_id, faults_.data());
  if (!executor_.counts_only()) executor_.synchronize();
  return solve_prepared(b, tolerance, max_iterations, stopwatch.seconds());
}

LinearReport ExecutorPcg::solve_with_last(const ExecutorMatrix& matrix, const FixedMask* fixed,
                                          const double* b, double* x, double tolerance, int max_iterations) {
  place(matrix, fixed, x);
  return solve_prepared(b, tolerance, max_iterations, 0);
}

LinearReport ExecutorPcg::solve_prepared(const double* b, double tolerance, int max_iterations,
                                         double setup_s) {
  LinearReport report;
  report.iterative = true;
  report.tolerance = tolerance;
  const Stopwatch stopwatch;
  b_ = b;
  host_ = {};
  host_.tolerance = tolerance, host_.max_iterations = max_iterations;
  scalars_.set(0, host_);
  if (executor_.counts_only()) return report;
  report.factor_s = setup_s;

  executor_.fill_bytes(v_.x, 0, static_cast<std::size_t>(3 * v_.partition.n_rows) * sizeof(double));
  set_residual(b, nullptr, v_.r);
  begin_run(true);
  if (!plain_) prepare_graph();
  report.status = solve_by_runs(report);
  if (host_.state[0].end == CgEnd::no_preconditioner) report.status = judge_fault(report);
  if (report.detail.empty()) report.detail = solve_detail(report);
  report.solve_s = stopwatch.seconds();
  return report;
}

}  // namespace bb::exec
