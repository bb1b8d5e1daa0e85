#include "core/linear/conjugate_gradients.hpp"

#include "core/linear/solve_detail.hpp"

namespace bb {

double ConjugateGradients::true_residual() {
  a_->multiply(*x_, ap_);
  ap_ = *b_ - ap_;
  rr_ = dot_(ap_, ap_);
  return std::sqrt(rr_);
}

// x and r after a step along p, and the next p where there is a next iteration.
CgState ConjugateGradients::iterate(const CgState& now, double alpha) {
  add_scaled(alpha, p_, *x_);
  add_scaled(-alpha, ap_, r_);
  CgState after = cg_take_residual(now, dot_(r_, r_), goal_.target);
  if (after.iteration > now.iteration) alpha_.push_back(alpha);
  if (!after.running()) return after;
  preconditioner_->apply(r_, z_);
  after = cg_go_on(after, dot_(r_, z_), max_iterations_);
  if (!after.running()) return after;
  beta_.push_back(after.rz / now.rz);
  scale_and_add(beta_.back(), z_, p_);
  return after;
}

CgRun ConjugateGradients::run() {
  alpha_.clear();
  beta_.clear();
  preconditioner_->apply(r_, z_);
  p_ = z_;
  CgState now = cg_begin(dot_(r_, z_), rr_, iteration_, max_iterations_, true);
  double curvature = 0;
  while (now.running()) {
    a_->multiply(p_, ap_);
    curvature = dot_(p_, ap_);
    if (!gives_step(curvature)) {
      now.end = CgEnd::curvature;
      break;
    }
    now = iterate(now, now.rz / curvature);
  }
  iteration_ = now.iteration;
  return {now, goal_, curvature};
}

LinearStatus ConjugateGradients::solve(const SymmetricProduct& a, const Preconditioner& preconditioner,
                                       const VecXd& b, double tolerance, int max_iterations, VecXd& x,
                                       LinearReport& report) {
  a_ = &a;
  preconditioner_ = &preconditioner;
  b_ = &b;
  x_ = &x;
  max_iterations_ = max_iterations;
  iteration_ = report.iterations;
  x = VecXd::Zero(b.size());
  r_ = b;
  rr_ = dot_(b, b);
  goal_ = cg_goal(rr_, tolerance);
  report.tolerance = tolerance;
  report.status = solve_by_runs(report);
  report.detail = solve_detail(report);
  return report.status;
}

}  // namespace bb
