// Gradient and matrix of the iterate, summed in the order that docs/design.md fixes; and the solve with
// prescribed motion lifted to the right-hand side.
#include <algorithm>

#include "core/newton/newton_system.hpp"

namespace bb {

void NewtonSystem::assemble() {
  for (const Slot& slot : slots_) {
    if (slot.term->group() == TermGroup::elastic) linearise(*slot.term);
  }
  {
    const ScopedPhase timer(clock_, Phase::assembly);
    pattern_changed_ = set_changing_families();
    blocks_->clear();
    add_matrices(TermGroup::elastic);
    if (plan_.policy_submatrix.needed) elastic_ = blocks_->values();
    gradient_.setZero(3, x_.cols());
  }
  for (const Slot& slot : slots_) {
    if (slot.term->group() != TermGroup::elastic) linearise(*slot.term);
    add_gradient(slot);
  }
  const ScopedPhase timer(clock_, Phase::assembly);
  add_matrices(TermSet::all().without(TermGroup::elastic));
  full_ = blocks_->values();
}

void NewtonSystem::linearise(Term& term) {
  const ScopedPhase timer(clock_, term.phase());
  term.linearise(x_, context());
}

bool NewtonSystem::set_changing_families() {
  std::vector<Stencils> families;
  for (const auto& term : terms_) {
    if (term->fixed_stencils()) continue;
    for (const TermFamily& family : term->families()) families.push_back(family.stencils);
  }
  return blocks_->set_contacts(std::move(families));
}

void NewtonSystem::add_families(const Slot& slot, Positions& gradient) const {
  std::size_t family = slot.first;
  for (const TermFamily& part : slot.term->families()) {
    if (slot.term->fixed_stencils()) {
      blocks_->gather_elements(family++, part.local.grad, gradient);
    } else {
      blocks_->gather_contacts(family++, part.local.grad, gradient);
    }
  }
}

// Elements that come and go are summed by themselves first.
void NewtonSystem::add_gradient(const Slot& slot) {
  const ScopedPhase timer(clock_, Phase::assembly);
  if (slot.term->fixed_stencils()) return add_families(slot, gradient_);
  part_.setZero(3, x_.cols());
  add_families(slot, part_);
  gradient_ += part_;
}

void NewtonSystem::add_matrix(const Slot& slot) {
  std::size_t family = slot.first;
  for (const TermFamily& part : slot.term->families()) {
    if (part.local.hess.empty()) {
      ++family;
    } else if (slot.term->fixed_stencils()) {
      blocks_->add_elements(family++, part.local.hess);
    } else {
      blocks_->add_contacts(family++, part.local.hess);
    }
  }
}

void NewtonSystem::add_matrices(TermSet set) {
  for (const Slot& slot : matrix_order_) {
    if (set.has(slot.term->group())) add_matrix(slot);
  }
}

const BlockSystem::Values& NewtonSystem::matrix(TermSet set) {
  blocks_->clear();
  add_matrices(set);
  return blocks_->values();
}

const ReducedSystem& NewtonSystem::reduced(TermSet set) {
  return blocks_->reduce(set == TermSet::all() ? full_ : matrix(set));
}

double NewtonSystem::add_tikhonov(double relative, double absolute) {
  const ScopedPhase timer(clock_, Phase::assembly);
  const ReducedSystem& reduced = blocks_->reduce(full_);
  const double mean = reduced.lower.diagonal().sum() / static_cast<double>(reduced.lower.rows());
  const double eps = std::max(relative * mean, absolute);
  matrix(TermSet::all());
  blocks_->add_diagonal(std::vector<double>(scene_.mass.size(), eps));
  full_ = blocks_->values();
  return eps;
}

// What prescribed displacements add to the right-hand side: -A_fp dx_p for the blocks of the matrix, and what
// terms add for given vertices that have none. dx is 0 at free vertices.
void NewtonSystem::lift(const Positions& dx, Positions& rhs) {
  part_.setZero(3, dx.cols());
  blocks_->multiply_add(full_, dx, part_);
  for (const auto& term : terms_) term->add_given_motion(x_, dx, part_);
  rhs -= part_;
}

LinearReport NewtonSystem::solve(const Positions& target, Positions& dx) {
  const ScopedPhase timer(clock_, Phase::assembly);
  dx.setZero(3, x_.cols());
  work_ = -gradient_;
  bool moving = false;
  for (const Pin& pin : scene_.pins) {
    dx.col(pin.vertex) = target.col(pin.vertex) - x_.col(pin.vertex);
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

}  // namespace bb
