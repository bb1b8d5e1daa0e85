// Gradient and matrix of the current state, in the order that docs/design.md fixes: elastic, snapshot H,
// inertia, limit, contact; and the solve with prescribed motion lifted to the right-hand side.
#include <algorithm>
#include <cmath>

#include "core/newton/newton_system.hpp"

namespace bb {

void NewtonSystem::assemble() {
  {
    const ScopedPhase timer(clock_, Phase::elastic);
    for (std::size_t i = 0; i < elements_.size(); ++i) elements_[i]->derivatives(state_.x, local_[i]);
  }
  {
    const ScopedPhase timer(clock_, Phase::assembly);
    // local terms sit on the compact free slots of either table
    pattern_changed_ = blocks_->set_contacts({{4, state_.rows.vertex}, {4, state_.mollified.free_vertex}});
    blocks_->clear();
    for (std::size_t i = 0; i < elements_.size(); ++i) blocks_->add_elements(i, local_[i].hess);
    if (need_elastic_) elastic_ = blocks_->values();
  }
  assemble_limit();
  gather_gradient();
  {
    const ScopedPhase timer(clock_, Phase::stiffness);
    start_policy();
    const double change = stiffness_.refresh(state_.rows, state_.mollified, *blocks_, elastic_);
    kappa_change_ = first_iterate_ ? 0 : change;
    first_iterate_ = false;
  }
  {
    const ScopedPhase timer(clock_, Phase::contact_terms);
    fill_contact_terms();
    evaluate_contact_energies(state_);
  }
  assemble_matrix();
}

// Local terms of the limit, from a kappa that its rule refreshes first.
void NewtonSystem::assemble_limit() {
  if (!limit_) return;
  const ScopedPhase timer(clock_, Phase::strain_limit);
  limit_kappa_change_ = 0;
  refresh_limit_stiffness();
  limit_->derivatives(state_.x, method_.limit, limit_kappa_.data(), limit_local_);
}

// The matrix beyond the elastic part, and the contact gradient.
void NewtonSystem::assemble_matrix() {
  const ScopedPhase timer(clock_, Phase::assembly);
  blocks_->add_diagonal(terms_.inertia);
  if (keep_stages_) no_limit_ = blocks_->values();
  if (limit_) blocks_->add_elements(elements_.size(), limit_local_.hess);
  if (keep_stages_) no_contact_ = blocks_->values();
  blocks_->add_contacts(0, contact_hess_);
  blocks_->add_contacts(1, mollified_hess_);
  full_ = blocks_->values();
  gradient_ += contact_gradient_;
}

// Local terms of the current rows and the gradient of B, from the kappa that stands in the rows.
void NewtonSystem::fill_contact_terms() {
  const ScopedPhase timer(clock_, Phase::contact_terms);
  evaluate_shape(state_.rows);
  evaluate_shape(state_.mollified);
  contact_terms(state_.rows, state_.x, method_.hessian_mode, contact_grad_, contact_hess_);
  mollified_terms(state_.mollified, state_.x, mollified_grad_, mollified_hess_);
  const ScopedPhase gathers(clock_, Phase::assembly);
  contact_gradient_.setZero(3, state_.x.cols());
  blocks_->gather_contacts(0, contact_grad_, contact_gradient_);
  blocks_->gather_contacts(1, mollified_grad_, contact_gradient_);
}

// Gradient of E without contact; elements' energies of the current state come along.
void NewtonSystem::gather_gradient() {
  const ScopedPhase timer(clock_, Phase::assembly);
  gradient_.resize(3, state_.x.cols());
  for (Eigen::Index i = 0; i < state_.x.cols(); ++i) {
    gradient_.col(i) =
        terms_.inertia[static_cast<std::size_t>(i)] * (state_.x.col(i) - terms_.x_tilde.col(i)) -
        terms_.force.col(i);
  }
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    state_.element[i] = local_[i].energy;
    blocks_->gather_elements(i, local_[i].grad, gradient_);
  }
  if (limit_) {
    state_.limit = limit_local_.energy;
    blocks_->gather_elements(elements_.size(), limit_local_.grad, gradient_);
  }
}

void NewtonSystem::refresh_limit_stiffness() {
  const LimitStiffness& rule = method_.limit_stiffness;
  if (limit_kappa_fresh_ && (rule.kind == LimitStiffness::Kind::fixed || rule.refresh == Refresh::per_step))
    return;
  limit_kappa_fresh_ = true;
  if (rule.kind == LimitStiffness::Kind::fixed) {
    limit_->fixed_stiffness(rule.k_s, limit_kappa_.data());
    return;
  }
  limit_kappa_before_ = limit_kappa_;
  limit_hess_.resize(81 * limit_->size());
  Mat<double, 12, 12> block;
  for (std::size_t e = 0; rule.elastic_term && e < limit_->size(); ++e) {
    blocks_->submatrix(elastic_, &limit_->vertices()[3 * e], 3, block.data());
    Eigen::Map<Mat<double, 9, 9>> target(&limit_hess_[81 * e]);
    target = block.topLeftCorner<9, 9>();
  }
  limit_->measure(state_.x);
  const StrainStiffnessRule terms = rule.rule(dt_, c_);
  limit_->elastic_stiffness(terms_.x_n, limit_hess_.data(), scene_.mass.data(), scene_.limit.mass.data(),
                            terms, limit_kappa_.data());
  for (double& kappa : limit_kappa_) kappa *= rule.multiplier;
  limit_kappa_change_ = first_iterate_ ? 0 : limit_change();
}

// Largest relative change of an active element's kappa.
double NewtonSystem::limit_change() const {
  double change = 0;
  for (std::size_t e = 0; e < limit_->size(); ++e) {
    const double gap = std::min(limit_->gaps()[2 * e], limit_->gaps()[2 * e + 1]);
    if (!(gap < scene_.limit.width[e])) continue;
    change = std::max(change, relative_change(limit_kappa_before_[e], limit_kappa_[e]));
  }
  return change;
}

// A policy with memory starts at the first iterate that has contacts: sums of grad B with kappa = 1 and grad
// E_rest.
void NewtonSystem::start_policy() {
  StiffnessPolicy& policy = stiffness_.policy();
  ContactTable& rows = state_.rows;
  MollifiedTable& mollified = state_.mollified;
  if (policy_started_ || !policy.needs_globals() || rows.size() + mollified.size() == 0) return;
  std::fill(rows.kappa.begin(), rows.kappa.end(), 1.0);
  std::fill(mollified.kappa.begin(), mollified.kappa.end(), 1.0);
  fill_contact_terms();

  StiffnessGlobals globals;
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (fixed_[i]) continue;
    globals.grad_b_dot_grad_e += contact_gradient_.data()[i] * gradient_.data()[i];
    globals.grad_b_sq += contact_gradient_.data()[i] * contact_gradient_.data()[i];
  }
  double mass = 0;
  int count = 0;
  for (const std::vector<int>* vertices : {&rows.vertex, &mollified.free_vertex}) {
    for (const int vertex : *vertices) {
      if (vertex < 0) continue;
      mass += scene_.mass[static_cast<std::size_t>(vertex)];
      ++count;
    }
  }
  globals.mean_contact_mass = mass / count;
  globals.d_hat = min_d_hat_;
  globals.d2b_half = method_.contact.eval(globals.d_hat / 2, globals.d_hat).d2b;
  globals.dt = dt_;
  globals.c = c_;
  policy.start(globals);
  policy_started_ = true;
}

// What prescribed displacements add to the right-hand side: -A_fp dx_p for the elements, and what every
// contact row adds for its given vertices, which have no matrix block. dx is 0 at free vertices.
void NewtonSystem::lift(const Positions& dx, Positions& rhs) const {
  Positions coupled = Positions::Zero(3, dx.cols());
  blocks_->multiply_add(full_, dx, coupled);
  add_given_motion(state_.rows, dx, coupled);
  add_given_motion(state_.mollified, state_.x, dx, coupled);
  rhs -= coupled;
}

LinearReport NewtonSystem::solve(const Positions& target, Positions& dx) {
  const ScopedPhase timer(clock_, Phase::assembly);
  dx.setZero(3, state_.x.cols());
  work_ = -gradient_;
  bool moving = false;
  for (const Pin& pin : scene_.pins) {
    dx.col(pin.vertex) = target.col(pin.vertex) - state_.x.col(pin.vertex);
    moving = moving || !dx.col(pin.vertex).isZero(0);
  }
  if (moving) lift(dx, work_);
  blocks_->restrict_vector(work_, rhs_);
  const ReducedSystem& reduced = blocks_->reduce(full_);
  nnz_ = static_cast<std::size_t>(reduced.lower.nonZeros());
  const LinearReport report = solve_reduced(reduced);
  if (report.status == LinearStatus::ok) blocks_->expand_vector(solution_, dx);
  return report;
}

// The solver measures its own parts; what is neither analysis nor factorisation is solution.
LinearReport NewtonSystem::solve_reduced(const ReducedSystem& reduced) {
  const ScopedPhase timer(clock_, Phase::linear_solve);
  LinearReport report = solver_->solve(reduced, rhs_, solution_);
  clock_.move(Phase::linear_solve, Phase::linear_analyze, report.analyze_s);
  clock_.move(Phase::linear_solve, Phase::linear_factor, report.factor_s);
  return report;
}

double NewtonSystem::add_tikhonov(double relative, double absolute) {
  const ScopedPhase timer(clock_, Phase::assembly);
  const ReducedSystem& reduced = blocks_->reduce(full_);
  const double mean = reduced.lower.diagonal().sum() / static_cast<double>(reduced.lower.rows());
  const double eps = std::max(relative * mean, absolute);
  blocks_->add_diagonal(std::vector<double>(scene_.mass.size(), eps));
  full_ = blocks_->values();
  return eps;
}

bool NewtonSystem::has_stage(MatrixStage stage) const {
  switch (stage) {
    case MatrixStage::full:
      return true;
    case MatrixStage::without_contact:
      return keep_stages_ && state_.rows.size() + state_.mollified.size() > 0;
    case MatrixStage::without_contact_and_limit:
      return keep_stages_ && limit_ != nullptr;
  }
  return false;
}

const ReducedSystem& NewtonSystem::reduced(MatrixStage stage) {
  switch (stage) {
    case MatrixStage::full:
      return blocks_->reduce(full_);
    case MatrixStage::without_contact:
      return blocks_->reduce(no_contact_);
    case MatrixStage::without_contact_and_limit:
      return blocks_->reduce(no_limit_);
  }
  return blocks_->reduce(full_);
}

}  // namespace bb
