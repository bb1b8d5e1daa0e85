// The Newton matrix of the iterate at the level that makes it positive definite, and its solve with
// prescribed motion lifted to the right-hand side.
#include <algorithm>

#include "core/newton/newton_system.hpp"

namespace bb {

void NewtonSystem::clamp(Slot& slot) {
  if (slot.clamped || slot.hessian == StepHessian::clamped) return;
  const ScopedPhase timer(clock(), slot.term->phase());
  slot.term->clamp(x_);
  slot.clamped = true;
}

// The sum of hessian_of(slot, family), lower blocks [elements], over the terms of a set. Left in blocks_.
template <class HessianOf>
void NewtonSystem::sum_matrices(TermSet set, const HessianOf& hessian_of) {
  const ScopedPhase timer(clock(), Phase::assembly);
  blocks_->clear();
  for (const std::size_t i : matrix_order_) {
    const Slot& slot = slots_[i];
    if (!set.has(slot.term->group())) continue;
    std::size_t index = slot.first;
    for (const TermFamily& family : slot.term->families()) {
      const std::size_t number = index++;
      if (family.local.hess.empty()) continue;
      const std::span<const double> hess = hessian_of(slot, family);
      slot.term->fixed_stencils() ? blocks_->add_elements(number, hess) : blocks_->add_contacts(number, hess);
    }
  }
}

void NewtonSystem::clamp(TermSet set) {
  for (Slot& slot : slots_) {
    if (set.has(slot.term->group())) clamp(slot);
  }
}

// After clamp().
std::span<const double> NewtonSystem::clamped_hessians(const Slot& slot, const TermFamily& family) {
  return slot.hessian == StepHessian::clamped ? family.local.hess : family.clamped.hess;
}

void NewtonSystem::sum_clamped(TermSet set) {
  clamp(set);
  sum_matrices(set, clamped_hessians);
}

void NewtonSystem::visit_clamped(TermSet set, const VisitHessians& visit) {
  clamp(set);
  for (const Slot& slot : slots_) {
    if (!set.has(slot.term->group())) continue;
    const std::span<const TermFamily> families = slot.term->families();
    for (std::size_t i = 0; i < families.size(); ++i) {
      if (families[i].local.hess.empty()) continue;
      visit(*slot.term, i, clamped_hessians(slot, families[i]));
    }
  }
}

// At the level of the next attempt.
void NewtonSystem::fill_matrix() {
  for (Slot& slot : slots_) {
    if (needs_clamped(slot.hessian, level_)) clamp(slot);
  }
  sum_matrices(TermSet::all(), [this](const Slot& slot, const TermFamily& family) {
    return hessian_at(family, slot.hessian, level_, force_, hess_buffer_);
  });
  const ScopedPhase timer(clock(), Phase::assembly);
  if (shift_ > 0) blocks_->add_diagonal(std::vector<double>(scene_.mass.size(), shift_));
  blocks_->take_values(full_);
}

// Of a vertex, over its free degrees of freedom.
double NewtonSystem::largest_force() {
  force_.resize(fixed_.size() / 3);
  double largest = 0;
  for (std::size_t v = 0; v < force_.size(); ++v) {
    Vec3d g = gradient_.col(static_cast<Eigen::Index>(v));
    for (std::size_t k = 0; k < 3; ++k) {
      if (fixed_[3 * v + k]) g[static_cast<Eigen::Index>(k)] = 0;
    }
    force_[v] = g.norm();
    largest = std::max(largest, force_[v]);
  }
  return largest;
}

const ReducedSystem& NewtonSystem::fixed_pattern() {
  blocks_->set_contacts({});
  blocks_->clear();
  return blocks_->reduce(blocks_->values());
}

const ReducedSystem& NewtonSystem::solved() { return blocks_->reduce(full_); }

const BlockSystem::Values& NewtonSystem::clamped_values(TermSet set) {
  sum_clamped(set);
  return blocks_->values();
}

const ReducedSystem& NewtonSystem::clamped(TermSet set) { return blocks_->reduce(clamped_values(set)); }

const ReducedSystem& NewtonSystem::exact() {
  sum_exact();
  return blocks_->reduce(blocks_->values());
}

void NewtonSystem::sum_exact() {
  sum_matrices(TermSet::all(), [](const Slot&, const TermFamily& family) -> std::span<const double> {
    return family.local.hess;
  });
}

double NewtonSystem::exact_curvature(const Positions& dx) {
  sum_exact();
  part_.setZero(3, dx.cols());
  blocks_->multiply_add(blocks_->values(), dx, part_);
  return part_.cwiseProduct(dx).sum();
}

// Where the exact matrix is the one that was factorised, that is the proof. Rows that are clamped add to it: where it is
// not positive definite then, the exact one is not either.
EndCheck NewtonSystem::check_end() {
  const WholePhase timer(clock(), Phase::end_check);
  EndCheck out;
  const bool known = exact_hessians_ == ExactHessians::all;
  out.proof = EndProof::clamped;
  if (exact_hessians_ == ExactHessians::none) return out;
  if (factored_ && level_.exact() && shift_ == 0) {
    if (known) out.proof = EndProof::factor;
    return out;
  }
  examined_ = exact();
  const Definiteness found = solver_->examine(
      examined_, [this]() -> const ReducedSystem& { return level_.exact() ? clamped() : solved(); });
  factored_ = false;
  out.factorizations = found.factorizations;
  out.iterations = found.iterations;
  if (found.verdict == Definiteness::Verdict::unknown) out.proof = EndProof::unproven;
  if (found.verdict == Definiteness::Verdict::positive && known) {
    out.proof = found.by_factor ? EndProof::factor : EndProof::lanczos;
  }
  if (found.verdict != Definiteness::Verdict::negative) return out;
  out.proof = EndProof::saddle;
  out.curvature_N_per_m = found.curvature;
  escape_.setZero(3, x_.cols());
  blocks_->expand_vector(found.direction, escape_);
  return out;
}

void NewtonSystem::aim_at_escape(double length) {
  const double slope = gradient_.cwiseProduct(escape_).sum(), largest = escape_.cwiseAbs().maxCoeff();
  straight_ = dx_;
  dx_ = escape_ * ((slope > 0 ? -length : length) / largest);
}

double NewtonSystem::add_tikhonov(double relative, double absolute) {
  const ReducedSystem& reduced = blocks_->reduce(full_);
  const double mean = reduced.lower.diagonal().sum() / static_cast<double>(reduced.lower.rows());
  shift_ = std::max(relative * mean, absolute);
  fill_matrix();
  return shift_;
}

// What prescribed displacements add to the right-hand side: -A_fp dx_p for the blocks of the matrix, and what
// terms add for given vertices that have none. dx is 0 at free vertices.
void NewtonSystem::lift(const Positions& dx, Positions& rhs) {
  part_.setZero(3, dx.cols());
  blocks_->multiply_add(full_, dx, part_);
  for (const auto& term : terms_) term->add_given_motion(x_, dx, part_);
  rhs -= part_;
}

SolveReport NewtonSystem::solve(const Positions& target, Positions& dx) {
  SolveReport report;
  while (!direction(target, dx, report)) {
    const LinearStatus status = report.linear.status;  // another Hessian mends neither of these
    if (level_.last() || status == LinearStatus::non_finite || status == LinearStatus::factor_too_large)
      break;
    level_.raise(largest_force());
    fill_matrix();
  }
  served_at_once_ = report.attempts == 1;
  return report;
}

// dx: the motion of prescribed vertices. Whether there is one.
bool NewtonSystem::set_right_hand_side(const Positions& target, Positions& dx) {
  dx.setZero(3, x_.cols());
  work_ = -gradient_;
  bool moving = false;
  for (const Pin& pin : scene_.pins) {
    dx.col(pin.vertex) = target.col(pin.vertex) - x_.col(pin.vertex);
    moving = moving || !dx.col(pin.vertex).isZero(0);
  }
  if (moving) lift(dx, work_);
  blocks_->restrict_vector(work_, rhs_);
  return moving;
}

// One attempt. False when the matrix is not positive definite, or dx does not descend: that is asked for only
// where no prescribed motion does work.
bool NewtonSystem::direction(const Positions& target, Positions& dx, SolveReport& report) {
  const ScopedPhase timer(clock(), Phase::assembly);
  const bool moving = set_right_hand_side(target, dx);
  report.t = level_.t();
  solve_reduced(rhs_, report);
  if (report.linear.status != LinearStatus::ok) return false;
  blocks_->expand_vector(solution_, dx);
  return moving || rhs_.dot(solution_) > 0 || rhs_.isZero(0);
}

// With d_i(x + s) = d_i + slope_i - loss_i + grad d_i . s, s with A s = sum of m kappa b'' (what is missing) grad d_i makes
// up for the loss where the barrier is stiff, at the least cost to the other terms.
bool NewtonSystem::make_detour(double bound, SolveReport& report) {
  const ScopedPhase timer(clock(), Phase::assembly);
  part_.setZero(3, x_.cols());
  bool held = false;
  for (const auto& term : terms_) held = term->add_detour(x_, dx_, bound, part_) || held;
  if (!held) return false;
  VecXd force;
  blocks_->restrict_vector(part_, force);
  SolveReport detour;
  solve_reduced(force, detour);
  report.add_detour(detour);
  if (detour.linear.status != LinearStatus::ok) return false;
  straight_ = dx_;
  part_.setZero();
  blocks_->expand_vector(solution_, part_);
  dx_ += part_;
  return true;
}

// The solver measures its own parts; what is neither analysis nor factorisation is solution.
void NewtonSystem::solve_reduced(const VecXd& rhs, SolveReport& report) {
  const ReducedSystem& reduced = blocks_->reduce(full_);
  nnz_ = static_cast<std::size_t>(reduced.lower.nonZeros());
  const ScopedPhase timer(clock(), Phase::linear_solve);
  LinearReport linear = solver_->solve(reduced, rhs, solution_);
  clock().move(Phase::linear_solve, Phase::linear_analyze, linear.analyze_s);
  clock().move(Phase::linear_solve, Phase::linear_factor, linear.factor_s);
  ++report.attempts;
  report.factorizations += linear.factorized ? 1 : 0;
  factored_ = linear.factorized;
  report.factor_flop += linear.factor_flop;
  report.analyses += linear.analyzed ? 1 : 0;
  linear.iterations += report.linear.iterations;
  report.linear = linear;
}

}  // namespace bb
