// Gradient and matrix of the iterate, products and solves with it.
#include <stdexcept>

#include "core/resident/linear/pcg_kernels.hpp"
#include "core/resident/system/resident_potential.hpp"

namespace bb::resident {

void ResidentPotential::linearise(const Column& x, Column& g) {
  if (plan_.policy_submatrix.needed) {
    const ScopedPhase timer(clock(), Phase::elastic);
    fill_elastic(x);
    keep_elastic();
  }
  {
    const ScopedPhase timer(clock(), Phase::strain_limit);
    limit_kappa_change_ = elements_.refresh_limit(x.data());
  }
  {
    const ScopedPhase timer(clock(), Phase::elastic);
    elements_.linearise(x.data(), g.data());
    energies_known_ = true;
  }
  if (contact_) {
    const ScopedPhase timer(clock(), Phase::contact_terms);
    contact_->linearise(x, kept_elastic(), g);
  }
  if (pattern_changed()) ++pattern_id_;
}

// H, which stiffness policies read: every elastic element clamped.
void ResidentPotential::fill_elastic(const Column& x) {
  elements_.clear_matrix();
  elements_.add_matrix(TermGroup::elastic, x.data(), clamped_hessian);
}

// What kappa of contacts is made of: the H of the iterate, which trial states ask for when the matrix holds all terms
// again; of a policy with a potential that of the step's first iterate, all through it.
void ResidentPotential::keep_elastic() {
  if (!contact_ || !contact_->needs_hessian()) return;
  if (contact_->policy().has_potential() && has_step_elastic_) return;
  has_step_elastic_ = true;
  const MatrixPart matrix = elements_.matrix();
  elastic_value_.resize(value_count(elements_.n_blocks()));
  executor_->copy(elastic_value_.data(), matrix.value,
                  static_cast<std::size_t>(elastic_value_.size()) * sizeof(double));
}

MatrixPart ResidentPotential::kept_elastic() const {
  MatrixPart part = elements_.matrix();
  if (elastic_value_.size() > 0) part.value = elastic_value_.data();
  return part;
}

HessianChoice ResidentPotential::contact_choice(double t) const {
  const StepHessian choice = method_.hessian_of("contact");
  HessianChoice out{method_.hessian_mode, first_projection(choice), false, 1};
  const bool begins_exact = choice == StepHessian::blend || choice == StepHessian::exact_or_clamped;
  if (!begins_exact || t == 0) return out;
  out.projection = Projection::psd;
  out.blended = choice == StepHessian::blend && t < 1;
  out.t = t;
  return out;
}

void ResidentPotential::fill_matrix(const Column& x, const HessianLevel& level, const Column& force) {
  level_ = {level.t(), level.threshold(), force.data()};
  fill(x, level_);
}

void ResidentPotential::fill_exact(const Column& x, const Column& force) {
  fill(x, {0, infinity, force.data()});
}

void ResidentPotential::fill(const Column& x, const Filled& level) {
  const ScopedPhase timer(clock(), Phase::assembly);
  elements_.clear_matrix();
  elements_.add_matrix(TermSet::all(), x.data(), [&](std::string_view term) {
    return hessian_request(method_.hessian_of(term), level.t, level.threshold, level.force);
  });
  if (contact_) contact_matrix_ = contact_->matrix(x, contact_choice(level.t));
}

ResidentMatrix ResidentPotential::matrix() const { return {{elements_.matrix(), contact_matrix_}}; }

std::size_t ResidentPotential::nnz() const {
  return 9 * static_cast<std::size_t>(elements_.n_blocks() + (contact_ ? contact_->n_blocks() : 0)) / 2;
}

double ResidentPotential::add_tikhonov(double, double) {
  throw std::logic_error("the matrix on an executor has no Tikhonov term: only article_literal asks for one");
}

void ResidentPotential::multiply(const Column& v, Column& out) {
  const Partition partition = Partition::of(v.size() / 3);
  executor_->blocks(partition.n_blocks(), MultiplyDot{partition, matrix(), vectors_.fixed().data(), v.data(),
                                                      out.data(), product_partial_.data(), nullptr});
}

void ResidentPotential::add_given_motion(const Column& x, const Column& motion, Column& force) {
  if (contact_) contact_->add_given_motion(x, motion, force);
}

void ResidentPotential::solve(const Column& b, Column& step, SolveReport& report) {
  const ScopedPhase timer(clock(), Phase::linear_solve);
  const double b_norm = pcg_->norm(vectors_.fixed().data(), b.data());
  LinearReport linear;
  linear.iterative = true;
  step.fill_zero();
  if (!std::isfinite(b_norm)) {
    linear.status = LinearStatus::non_finite;
    linear.residual_true = linear.residual_recurrence = 1;
  } else if (b_norm != 0) {
    linear = pcg_->solve(matrix(), vectors_.fixed().data(), b.data(), step.data(), forcing_.tolerance(b_norm),
                         max_pcg_iterations_, pattern_id_);
  }
  report.add_attempt(linear);
}

// Conjugate gradients on a seeded right-hand side (core/linear/definiteness.hpp), preconditioned by what served the
// matrix that was solved.
Definiteness ResidentPotential::examine(const Column& x, const HessianLevel&, const Column& force, Column& b,
                                        Column& step, Column& direction) {
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

}  // namespace bb::resident
