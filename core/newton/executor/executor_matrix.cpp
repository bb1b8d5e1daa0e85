// Gradient and matrix of the iterate, products and solves with it.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/linear/executor/pcg_kernels.hpp"
#include "core/newton/executor/executor_engine.hpp"
#include "core/terms/executor/hessian_request.hpp"

namespace bb::exec {
namespace {

/// Charges work to a phase until it is done: launches return at once, and whoever reads a number next would wait for them in
/// its own phase.
template <class Work>
void charge(PhaseClock& clock, Phase phase, Executor& executor, const Work& work) {
  const ScopedPhase timer(clock, phase);
  work();
  executor.synchronize();
}

}  // namespace

void ExecutorEngine::linearise_terms(const Column& x, Column& g) {
  if (plan_.policy_submatrix.needed) {
    charge(clock(), Phase::elastic, *executor_, [&] { fill_elastic(x); });
  }
  g.fill_zero();
  const ExecutorContext context{elements_.part(), elements_.n_blocks(), clock()};
  for (const auto& term : terms_) {
    charge(clock(), term->phase(), *executor_, [&] { term->linearise(x, context, g); });
  }
  if (pattern_changed()) ++pattern_id_;
}

bool ExecutorEngine::pattern_changed() const {
  return std::any_of(terms_.begin(), terms_.end(), [](const auto& term) { return term->pattern_changed(); });
}

// H, which stiffness policies read: every elastic element clamped.
void ExecutorEngine::fill_elastic(const Column& x) {
  elements_.clear();
  for (const auto& term : terms_) {
    if (term->group() == TermGroup::elastic) term->add_matrix(x, {});
  }
  elements_.mirror();
}

void ExecutorEngine::fill_matrix(const Column& x, const HessianRegularisation& level, const Column& force) {
  level_ = {level.t(), level.threshold(), force.data()};
  fill(x, level_);
}

void ExecutorEngine::fill_exact(const Column& x, const Column& force) {
  fill(x, {0, infinity, force.data()});
}

// H first, as on the host.
void ExecutorEngine::fill(const Column& x, const Filled& level) {
  charge(clock(), Phase::assembly, *executor_, [&] {
    elements_.clear();
    for (const bool elastic : {true, false}) {
      for (const auto& term : terms_) {
        if ((term->group() == TermGroup::elastic) != elastic) continue;
        term->add_matrix(
            x, hessian_request(method_.hessian_of(term->name()), level.t, level.threshold, level.force));
      }
    }
    elements_.mirror();
  });
}

ExecutorMatrix ExecutorEngine::matrix() const {
  ExecutorMatrix out{};
  out.part[0] = elements_.part();
  int n = 1;
  for (const auto& term : terms_) {
    const MatrixPart own = term->changing_matrix().part;
    if (!own.row_begin) continue;
    if (n == ExecutorMatrix::most_parts) throw std::logic_error("more terms whose stencils come and go");
    out.part[n++] = own;
  }
  return out;
}

std::size_t ExecutorEngine::nnz() const {
  Index n = elements_.n_blocks();
  for (const auto& term : terms_) n += term->changing_matrix().n_blocks;
  return 9 * static_cast<std::size_t>(n) / 2;
}

double ExecutorEngine::add_tikhonov(double, double) {
  throw std::logic_error("the matrix on an executor has no Tikhonov term: only article_literal has one");
}

void ExecutorEngine::multiply(const Column& v, Column& out) {
  const Partition partition = Partition::of(v.size() / 3);
  executor_->blocks(partition.n_blocks(), MultiplyDot{partition, matrix(), vectors_.fixed().data(), v.data(),
                                                      out.data(), product_partial_.data(), nullptr});
}

void ExecutorEngine::solve(const Column& b, RightSide of, Column& step, SolveReport& report) {
  executor_->synchronize();  // what made the right-hand side is the caller's phase
  const ScopedPhase timer(clock(), Phase::linear_solve);
  const double b_norm = pcg_->norm(vectors_.fixed().data(), b.data());
  LinearReport linear;
  linear.iterative = true;
  step.fill_zero();
  if (!std::isfinite(b_norm)) {
    linear.status = LinearStatus::non_finite;
    linear.residual_true = linear.residual_recurrence = 1;
  } else if (b_norm != 0) {
    linear = pcg_->solve(matrix(), vectors_.fixed().data(), b.data(), step.data(),
                         forcing_.tolerance(b_norm, of), max_pcg_iterations_, pattern_id_);
  }
  clock().move(Phase::linear_solve, Phase::linear_factor, linear.factor_s);
  report.add_attempt(linear);
}

// Conjugate gradients on a seeded right-hand side (core/linear/definiteness.hpp), preconditioned by what served the
// matrix that was solved.
Definiteness ExecutorEngine::examine(const Column& x, const HessianRegularisation&, const Column& force,
                                     Column& b, Column& step, Column& direction) {
  fill_exact(x, force);
  const VecXd seeded = definiteness_right_hand_side(b.size());
  b.upload({seeded.data(), static_cast<std::size_t>(seeded.size())});
  Definiteness found = definiteness_of(pcg_->solve_with_last(
      matrix(), vectors_.fixed().data(), b.data(), step.data(), definiteness_tolerance, max_pcg_iterations_));
  if (found.verdict != Definiteness::Verdict::negative) return found;
  direction.copy_from(pcg_->direction());
  multiply(direction, step);
  found.curvature =
      vectors_.free_dot(direction, step).value() / vectors_.free_dot(direction, direction).value();
  return found;
}

}  // namespace bb::exec
