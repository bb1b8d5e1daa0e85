// Gradient and matrix of the iterate, and the Newton direction: core/newton/newton_matrix.cpp on an executor.
#include <stdexcept>

#include "core/linear/definiteness.hpp"
#include "core/resident/linear/pcg_kernels.hpp"
#include "core/resident/system/resident_system.hpp"
#include "core/resident/system/system_kernels.hpp"

namespace bb::resident {

void ResidentSystem::assemble() {
  if (plan_.policy_submatrix.needed) {
    const ScopedPhase timer(clock(), Phase::elastic);
    fill_elastic();
    keep_elastic();
  }
  {
    const ScopedPhase timer(clock(), Phase::strain_limit);
    limit_kappa_change_ = elements_.refresh_limit(x_.data());
  }
  {
    const ScopedPhase timer(clock(), Phase::elastic);
    elements_.linearise(x_.data(), g_.data());
  }
  if (contact_) {
    const ScopedPhase timer(clock(), Phase::contact_terms);
    contact_->linearise(x_, kept_elastic(), g_);
  }
  if (pattern_changed()) ++pattern_id_;
  host_g_.valid = false;
  const double residual = largest_force();
  if (served_at_once_) level_.lower(residual);
  served_at_once_ = false;
  fill_matrix(false);
}

// H, which stiffness policies read: every elastic element clamped.
void ResidentSystem::fill_elastic() {
  elements_.clear_matrix();
  elements_.add_matrix(TermGroup::elastic, x_.data(), clamped_hessian);
}

// What kappa of contacts is made of: the H of the iterate, which trial states ask for when the matrix holds all terms
// again; of a policy with a potential that of the step's first iterate, all through it.
void ResidentSystem::keep_elastic() {
  if (!contact_ || !contact_->needs_hessian()) return;
  if (contact_->stiffness().rule().potential() && has_step_elastic_) return;
  has_step_elastic_ = true;
  const MatrixPart matrix = elements_.matrix();
  elastic_value_.resize(value_count(elements_.n_blocks()));
  executor_->copy(elastic_value_.data(), matrix.value,
                  static_cast<std::size_t>(elastic_value_.size()) * sizeof(double));
}

MatrixPart ResidentSystem::kept_elastic() const {
  MatrixPart part = elements_.matrix();
  if (elastic_value_.size() > 0) part.value = elastic_value_.data();
  return part;
}

HessianRequest ResidentSystem::request_of(StepHessian choice, bool exact) const {
  return hessian_request(choice, exact ? 0 : level_.t(), exact ? infinity : level_.threshold(),
                         force_.data());
}

HessianChoice ResidentSystem::contact_choice(bool exact) const {
  const StepHessian choice = method_.hessian_of("contact");
  const double t = exact ? 0 : level_.t();
  HessianChoice out{method_.hessian_mode, first_projection(choice), false, 1};
  const bool begins_exact = choice == StepHessian::blend || choice == StepHessian::exact_or_clamped;
  if (!begins_exact || t == 0) return out;
  out.projection = Projection::psd;
  out.blended = choice == StepHessian::blend && t < 1;
  out.t = t;
  return out;
}

// At the level of the next attempt, or the Hessian that every term begins with.
void ResidentSystem::fill_matrix(bool exact) {
  const ScopedPhase timer(clock(), Phase::assembly);
  elements_.clear_matrix();
  elements_.add_matrix(TermSet::all(), x_.data(),
                       [&](std::string_view term) { return request_of(method_.hessian_of(term), exact); });
  if (contact_) contact_matrix_ = contact_->matrix(x_, contact_choice(exact));
}

ResidentMatrix ResidentSystem::matrix() const { return {{elements_.matrix(), contact_matrix_}}; }

std::size_t ResidentSystem::nnz() const {
  return 9 * static_cast<std::size_t>(elements_.n_blocks() + (contact_ ? contact_->n_blocks() : 0)) / 2;
}

double ResidentSystem::largest_force() {
  vectors_.force_norms(g_, force_);
  return vectors_.max(force_);
}

double ResidentSystem::add_tikhonov(double, double) {
  throw std::logic_error("the resident system has no Tikhonov term: only article_literal asks for one");
}

// out = A v over free rows; returns v . out.
double ResidentSystem::multiply(const Column& v, Column& out) {
  const Partition partition = Partition::of(v.size() / 3);
  executor_->blocks(partition.n_blocks(), MultiplyDot{partition, matrix(), vectors_.fixed().data(), v.data(),
                                                      out.data(), product_partial_.data(), nullptr});
  sum_.clear();
  sum_.add(partition.n_blocks(), ColumnSum{product_partial_.data()});
  return sum_.get().value();
}

SolveReport ResidentSystem::find_direction() {
  SolveReport report;
  while (!direction(report)) {
    if (level_.last() || report.linear.status == LinearStatus::non_finite) break;
    level_.raise(largest_force());
    fill_matrix(false);
  }
  served_at_once_ = report.attempts == 1;
  return report;
}

// One attempt. False when the matrix is not positive definite, or dx does not descend: that is asked for only where no
// prescribed motion does work.
bool ResidentSystem::direction(SolveReport& report) {
  const ScopedPhase timer(clock(), Phase::assembly);
  const bool moving = vectors_.first_short_pin(x_) >= 0;
  dx_.fill_zero();
  vectors_.set_pin_motion(x_, dx_);
  if (moving) {
    multiply(dx_, work_);
    if (contact_) contact_->add_given_motion(x_, dx_, work_);
  }
  executor_->each(b_.size(), RightHandSide{g_.data(), moving ? work_.data() : nullptr, b_.data()});
  report.t = level_.t();
  LinearReport linear = solve_linear();
  ++report.attempts;
  linear.iterations += report.linear.iterations;
  report.linear = linear;
  if (report.linear.status != LinearStatus::ok) return false;
  executor_->each(dx_.size(), AddColumn{step_.data(), dx_.data()});
  return moving || vectors_.free_dot(b_, step_).value() > 0 || vectors_.free_max(b_) == 0;
}

// As NewtonSystem::make_detour(). A state that is asked for its end makes none, so the column of escapes is free.
bool ResidentSystem::make_detour(double bound, SolveReport& report) {
  const ScopedPhase timer(clock(), Phase::assembly);
  if (!contact_ || !contact_->make_room(x_, dx_, bound, b_)) return false;
  fill_matrix(false);  // its values may have been given back
  SolveReport detour;
  detour.linear = solve_linear();
  report.add_detour(detour);
  if (detour.linear.status != LinearStatus::ok) return false;
  executor_->copy(escape_.data(), dx_.data(), static_cast<std::size_t>(dx_.size()) * sizeof(double));
  executor_->each(dx_.size(), AddColumn{step_.data(), dx_.data()});
  return true;
}

LinearReport ResidentSystem::solve_linear() {
  const ScopedPhase timer(clock(), Phase::linear_solve);
  const double b_norm = pcg_->norm(vectors_.fixed().data(), b_.data());
  LinearReport report;
  report.iterative = true;
  if (!std::isfinite(b_norm)) {
    report.status = LinearStatus::non_finite;
    report.residual_true = report.residual_recurrence = 1;
    return report;
  }
  step_.fill_zero();
  if (b_norm == 0) return report;
  return pcg_->solve(matrix(), vectors_.fixed().data(), b_.data(), step_.data(), forcing_.tolerance(b_norm),
                     max_pcg_iterations_, pattern_id_);
}

DirectionSize ResidentSystem::direction_size() {
  DirectionSize size;
  const DirectionSizes found = vectors_.sizes(dx_, x_, body_size_);
  size.inf_m = found.largest;
  size.rounding_m = found.within;
  size.beyond_m = found.beyond;
  size.vertex_m = found.vertex;
  size.slope_J = vectors_.free_dot(g_, dx_).value();
  return size;
}

void ResidentSystem::scale_direction(double factor) {
  executor_->each(dx_.size(), ScaleColumn{factor, dx_.data()});
}

double ResidentSystem::direction_curvature() {
  fill_matrix(true);
  return multiply(dx_, work_);
}

// Conjugate gradients on a seeded right-hand side (core/linear/definiteness.hpp), preconditioned by what served the
// matrix that was solved.
EndCheck ResidentSystem::check_end() {
  const WholePhase timer(clock(), Phase::end_check);
  EndCheck out;
  out.proof = EndProof::clamped;
  if (exact_hessians_ == ExactHessians::none) return out;
  fill_matrix(true);
  const VecXd seeded = definiteness_right_hand_side(b_.size());
  b_.upload({seeded.data(), static_cast<std::size_t>(seeded.size())});
  const LinearReport report =
      pcg_->solve_with_last(matrix(), vectors_.fixed().data(), b_.data(), step_.data(),
                            definiteness_tolerance, max_pcg_iterations_);
  out.iterations = report.iterations;
  if (report.status == LinearStatus::ok) {
    if (exact_hessians_ == ExactHessians::all) out.proof = EndProof::lanczos;
    return out;
  }
  out.proof = EndProof::unproven;
  if (report.status != LinearStatus::matrix_indefinite) return out;
  executor_->copy(escape_.data(), pcg_->direction().data(),
                  static_cast<std::size_t>(escape_.size()) * sizeof(double));
  const double curvature = multiply(escape_, work_), squared = vectors_.free_dot(escape_, escape_).value();
  ++out.iterations;  // the one that met it
  out.proof = EndProof::saddle;
  out.curvature_N_per_m = curvature / squared;
  return out;
}

void ResidentSystem::aim_at_escape(double length) {
  const double slope = vectors_.free_dot(g_, escape_).value(), largest = vectors_.free_max(escape_);
  dx_.swap(escape_);
  scale_direction((slope > 0 ? -length : length) / largest);
}

}  // namespace bb::resident
