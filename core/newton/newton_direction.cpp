// Gradient and matrix of the iterate, and the Newton direction: the matrix at the level that makes it positive definite,
// its solve with prescribed motion lifted to the right-hand side, negative curvature.
#include "core/exec/sums/vector_kernels.hpp"
#include "core/linear/definiteness.hpp"
#include "core/newton/element_name.hpp"
#include "core/newton/newton_system.hpp"
#include "core/terms/cusps.hpp"

namespace bb {

void NewtonSystem::assemble() {
  state_.secant = state_.secant_asked;
  state_.potential->linearise(state_.x, state_.g);
  view_.forget_gradient();
  state_.direction_seen = false;
  state_.shift = 0;
  // Of the level that is exact already nothing depends on forces.
  if (!state_.level.exact()) {
    const double residual = largest_force();
    if (served_at_once_) state_.level.lower(residual);
  }
  served_at_once_ = false;
  fill_matrix();
}

// Of a vertex, over its free degrees of freedom.
double NewtonSystem::largest_force() {
  const ScopedPhase timer(clock(), Phase::assembly);
  state_.vectors.force_norms(state_.g, state_.force);
  return state_.vectors.max(state_.force);
}

// At the level of the next attempt.
void NewtonSystem::fill_matrix() { state_.potential->fill_matrix(state_.x, state_.level, state_.force); }

double NewtonSystem::add_tikhonov(double relative, double absolute) {
  state_.shift = state_.potential->add_tikhonov(relative, absolute);
  return state_.shift;
}

SolveReport NewtonSystem::find_direction() {
  SolveReport report;
  while (!find_one_direction(report)) {
    const LinearStatus status = report.linear.status;  // another Hessian mends neither of these
    if (state_.level.last() || status == LinearStatus::non_finite || status == LinearStatus::factor_too_large)
      break;
    state_.level.raise(largest_force());
    fill_matrix();
  }
  served_at_once_ = report.attempts == 1;
  return report;
}

// dx: the motion of prescribed vertices. Whether there is one.
bool NewtonSystem::set_right_hand_side() {
  state_.dx.fill_zero();
  state_.direction_seen = false;
  state_.vectors.set_pin_motion(state_.x, state_.dx);
  const bool moving = state_.first_short_pin() >= 0;
  if (moving) {
    state_.potential->multiply(state_.dx, state_.work);
    state_.potential->add_given_motion(state_.x, state_.dx, state_.work);
  }
  state_.executor.each(
      state_.b.size(),
      exec::RightHandSide{state_.g.data(), moving ? state_.work.data() : nullptr, state_.b.data()});
  return moving;
}

double NewtonSystem::set_up_system() {
  const ScopedPhase timer(clock(), Phase::assembly);
  set_right_hand_side();
  factored_ = served_at_once_ = false;
  return state_.level.t();
}

// One attempt. False when the matrix is not positive definite, or dx does not descend: that is requested only
// where no prescribed motion does work.
bool NewtonSystem::find_one_direction(SolveReport& report) {
  const ScopedPhase timer(clock(), Phase::assembly);
  const bool moving = set_right_hand_side();
  report.t = state_.level.t();
  state_.potential->solve(state_.b, moving ? RightSide::with_motion : RightSide::residual, state_.step,
                          report);
  factored_ = report.linear.factorized;
  if (report.linear.status != LinearStatus::ok) return false;
  take_solution();
  return moving || state_.vectors.solution_products().first.value() > 0 ||
         state_.vectors.free_max(state_.b) == 0;
}

// dx += the solution; what is required of both next is launched with it.
void NewtonSystem::take_solution() {
  state_.vectors.take_solution(state_.step, state_.b, state_.g, state_.dx);
  look_at_direction();
}

void NewtonSystem::look_at_direction() {
  state_.vectors.look_at_direction(state_.dx, state_.x, state_.body_size, value_epsilon(state_.precision));
  state_.direction_seen = true;
}

DirectionSize NewtonSystem::direction_size() {
  DirectionSize size;
  const bool seen = state_.direction_seen;
  if (!seen) look_at_direction();
  const double slope = seen ? state_.vectors.solution_products().second.value()
                            : state_.vectors.free_dot(state_.g, state_.dx).value();
  const exec::DirectionSizes found = state_.vectors.direction_sizes();
  state_.direction_seen = seen;
  size.inf_m = found.largest;
  size.rounding_m = found.within;
  size.beyond_m = found.beyond;
  size.vertex_m = found.vertex;
  size.slope_J = slope;
  return size;
}

void NewtonSystem::scale_direction(double factor) {
  state_.direction_seen = false;
  state_.executor.each(state_.dx.size(), exec::ScaleColumn{factor, state_.dx.data()});
}

double NewtonSystem::direction_curvature() {
  state_.potential->fill_exact(state_.x, state_.force);
  state_.potential->multiply(state_.dx, state_.work);
  return state_.vectors.free_dot(state_.dx, state_.work).value();
}

// Where the exact matrix is the one that was factorised, that is the proof. Rows that are clamped add to it: where it is
// not positive definite then, the exact one is not either.
EndCheck NewtonSystem::check_hessian() {
  EndCheck out;
  const bool known = exact_hessians_ == ExactHessians::all;
  out.proof = EndProof::clamped;
  if (exact_hessians_ == ExactHessians::none) return out;
  if (factored_ && state_.level.exact() && state_.shift == 0) {
    if (known) out.proof = EndProof::factor;
    return out;
  }
  const Definiteness found =
      state_.potential->examine(state_.x, state_.level, state_.force, state_.b, state_.step, state_.aside);
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
  return out;
}

bool NewtonSystem::take_secant(double share) {
  const bool taken = state_.potential->take_secant(share);
  state_.secant_asked = taken && share > 0;
  return taken;
}

EndCheck NewtonSystem::check_end() {
  const WholePhase timer(clock(), Phase::end_check);
  if (state_.secant) {  // it is stiffer than E: what was solved with it proves nothing
    state_.potential->leave_secants(state_.x, state_.g);
    state_.secant = state_.secant_asked = factored_ = false;
  }
  EndCheck out = check_hessian();
  look_for_cusps(out);
  return out;
}

// The derivatives of an element at a cusp are a choice, so the matrix proves nothing. Away from it E falls along the gradient's
// limits: a direction of no symmetry finds one of them.
void NewtonSystem::look_for_cusps(EndCheck& out) {
  const Cusps found = state_.potential->cusps(state_.x, t_end_);
  if (found.count == 0) return;
  const VecXd seeded = definiteness_right_hand_side(3 * static_cast<Eigen::Index>(found.vertices.size()));
  std::vector<double> way(static_cast<std::size_t>(state_.x.size()), 0.0);
  bool free = false;
  for (std::size_t i = 0; i < 3 * found.vertices.size(); ++i) {
    const std::size_t at = 3 * static_cast<std::size_t>(found.vertices[i / 3]) + i % 3;
    if (state_.fixed[at] != 0) continue;
    way[at] = seeded[static_cast<Eigen::Index>(i)];
    free = true;
  }
  if (!free) return;
  out.cusps = static_cast<int>(found.count);
  out.first_cusp =
      element_name(state_.scene, found.term, found.element, {found.vertices.data(), found.width});
  if (out.proof == EndProof::saddle) return;
  out.proof = EndProof::cusp;
  state_.aside.upload(way);
}

void NewtonSystem::aim_at_escape(double length) {
  const double slope = state_.vectors.free_dot(state_.g, state_.aside).value(),
               largest = state_.vectors.free_max(state_.aside);
  state_.dx.swap(state_.aside);
  state_.direction_seen = false;
  scale_direction((slope > 0 ? -length : length) / largest);
}

// With d_i(x + s) = d_i + slope_i - loss_i + grad d_i . s, s with A s = sum of kappa b'' (what is missing) grad d_i makes
// up for the loss where the barrier is stiff, at the least cost to the other terms. A state that is tested as an end
// makes no curvature correction, so the column of escapes is free.
bool NewtonSystem::correct_curvature(double bound, SolveReport& report) {
  const ScopedPhase timer(clock(), Phase::assembly);
  if (!state_.potential->curvature_correction(state_.x, state_.dx, bound, state_.b)) return false;
  SolveReport correction;
  state_.potential->solve(state_.b, RightSide::residual, state_.step, correction);
  factored_ = correction.linear.factorized;
  report.add_correction(correction);
  if (correction.linear.status != LinearStatus::ok) return false;
  state_.aside.copy_from(state_.dx);
  take_solution();
  return true;
}

}  // namespace bb
