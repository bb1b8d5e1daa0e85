// Gradient and matrix of the terms on the host, summed in the order that docs/reference/arithmetic.md fixes, and the linear solve.
#include <algorithm>
#include <optional>

#include "core/newton/host_engine.hpp"

namespace bb {

void HostEngine::linearise_terms(const Column& x, Column& g) {
  x_ = &x;
  for (Slot& slot : slots_) {
    if (slot.term->group() == TermGroup::elastic) linearise_term(slot, x, g);
  }
  {
    const ScopedPhase timer(clock(), Phase::assembly);
    pattern_changed_ = set_changing_families();
    g.fill_zero();
  }
  if (plan_.policy_submatrix.needed) {
    sum_clamped(TermGroup::elastic);  // a stiffness policy reads a positive semi-definite H
    blocks_->take_values(elastic_);
  }
  for (Slot& slot : slots_) {
    if (slot.term->group() != TermGroup::elastic) linearise_term(slot, x, g);
    add_gradient(slot, g);
  }
}

void HostEngine::linearise_term(Slot& slot, const Column& x, const Column& g) {
  const ScopedPhase timer(clock(), slot.term->phase());
  slot.term->linearise(points(x), context(points(g), slot.hessian));
  slot.clamped = false;
}

void HostEngine::leave_secants(const Column& x, const Column& g) {
  for (Slot& slot : slots_) {
    if (!slot.term->take_secant(0)) continue;
    linearise_term(slot, x, g);
    full_is_exact_ = exact_is_solved_ = false;
  }
}

bool HostEngine::set_changing_families() {
  std::vector<Stencils> families;
  for (const auto& term : terms_) {
    if (term->fixed_stencils()) continue;
    for (const TermFamily& family : term->families()) families.push_back(family.stencils);
  }
  return blocks_->set_contacts(std::move(families));
}

void HostEngine::add_families(const Slot& slot, PositionsSpan gradient) const {
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
void HostEngine::add_gradient(const Slot& slot, Column& g) {
  const ScopedPhase timer(clock(), Phase::assembly);
  if (slot.term->fixed_stencils()) return add_families(slot, points(g));
  part_.setZero(3, points(g).cols());
  add_families(slot, part_);
  points(g) += part_;
}

void HostEngine::clamp(Slot& slot) {
  if (slot.clamped || slot.hessian == StepHessian::clamped) return;
  const ScopedPhase timer(clock(), slot.term->phase());
  slot.term->clamp(points(*x_));
  slot.clamped = true;
}

void HostEngine::clamp(TermSet set) {
  for (Slot& slot : slots_) {
    if (set.has(slot.term->group())) clamp(slot);
  }
}

// The sum of hessian_of(slot, family), lower blocks [elements], over the terms of a set. Left in blocks_.
template <class HessianOf>
void HostEngine::sum_matrices(TermSet set, const HessianOf& hessian_of) {
  const ScopedPhase timer(clock(), Phase::assembly);
  blocks_->clear();
  for (const std::size_t i : matrix_order_) {
    const Slot& slot = slots_[i];
    if (!set.has(slot.term->group())) continue;
    std::size_t index = slot.first;
    for (const TermFamily& family : slot.term->families()) {
      const std::size_t number = index++;
      if (family.local.hess.empty()) continue;
      const LocalHessians hess = hessian_of(slot, family);
      slot.term->fixed_stencils() ? blocks_->add_elements(number, hess) : blocks_->add_contacts(number, hess);
    }
  }
}

// After clamp().
std::span<const double> HostEngine::clamped_hessians(const Slot& slot, const TermFamily& family) {
  return slot.hessian == StepHessian::clamped ? family.local.hess : family.clamped.hess;
}

void HostEngine::sum_clamped(TermSet set) {
  clamp(set);
  sum_matrices(set, clamped_hessians);
}

void HostEngine::fill_matrix(const Column&, const HessianRegularisation& level, const Column& force) {
  for (Slot& slot : slots_) {
    if (needs_clamped(slot.hessian, level)) clamp(slot);
  }
  const std::span<const double> forces{force.data(), static_cast<std::size_t>(force.size())};
  sum_matrices(TermSet::all(), [&](const Slot& slot, const TermFamily& family) {
    return hessian_at(family, slot.hessian, level, forces, hess_buffer_);
  });
  blocks_->take_values(full_);
  filled_ = &full_;
  full_is_exact_ = level.exact();
  exact_is_solved_ = false;
}

void HostEngine::sum_exact() {
  sum_matrices(TermSet::all(), [](const Slot&, const TermFamily& family) -> std::span<const double> {
    return family.local.hess;
  });
}

void HostEngine::fill_exact(const Column&, const Column&) {
  sum_exact();
  filled_ = &blocks_->values();
}

double HostEngine::add_tikhonov(double relative, double absolute) {
  const ReducedSystem& reduced = blocks_->reduce(full_);
  const double mean = reduced.lower.diagonal().sum() / static_cast<double>(reduced.lower.rows());
  const double shift = std::max(relative * mean, absolute);
  blocks_->take_values(full_);  // back to where sums are made
  if (shift > 0) blocks_->add_diagonal(std::vector<double>(scene_.mass.size(), shift));
  blocks_->take_values(full_);
  full_is_exact_ = full_is_exact_ && shift == 0;
  exact_is_solved_ = false;
  return shift;
}

void HostEngine::multiply(const Column& v, Column& out) {
  out.fill_zero();
  blocks_->multiply_add(*filled_, points(v), points(out));
}

const ReducedSystem& HostEngine::reduced() {
  const ReducedSystem& reduced = blocks_->reduce(full_);
  nnz_ = static_cast<std::size_t>(reduced.lower.nonZeros());
  return reduced;
}

// The solver measures its own parts; what is neither analysis nor factorisation is solution.
void HostEngine::solve(const Column& b, RightSide of, Column& step, SolveReport& report) {
  blocks_->restrict_vector(points(b), rhs_);
  const ReducedSystem& reduced = this->reduced();
  const ScopedPhase timer(clock(), Phase::linear_solve);
  const LinearReport linear = solver_->solve(reduced, rhs_, solution_, of);
  clock().move(Phase::linear_solve, Phase::linear_analyze, linear.analyze_s);
  clock().move(Phase::linear_solve, Phase::linear_factor, linear.factor_s);
  report.add_attempt(linear);
  exact_is_solved_ = full_is_exact_;
  step.fill_zero();
  if (linear.status == LinearStatus::ok) blocks_->expand_vector(solution_, points(step));
}

// Where the exact matrix was solved, what that has set up proves the end. Ways out of a saddle are found with one preconditioner alone, so that
// they are the same after every solve: that of a matrix that was solved, or of the clamped one where that was exact.
Definiteness HostEngine::examine(const Column&, const HessianRegularisation& near, const Column&, Column&,
                                 Column&, Column& direction) {
  std::optional<Definiteness> solved;
  if (exact_is_solved_) solved = solver_->examine_solved();
  if (solved && solved->verdict == Definiteness::Verdict::positive) return *solved;
  sum_exact();
  examined_ = blocks_->reduce(blocks_->values());
  Definiteness found = solver_->examine(examined_, [this, &near]() -> const ReducedSystem& {
    if (!near.exact()) return blocks_->reduce(full_);
    sum_clamped(TermSet::all());
    return blocks_->reduce(blocks_->values());
  });
  if (solved) found.iterations += solved->iterations;
  if (found.verdict != Definiteness::Verdict::negative) return found;
  direction.fill_zero();
  blocks_->expand_vector(found.direction, points(direction));
  return found;
}

}  // namespace bb
