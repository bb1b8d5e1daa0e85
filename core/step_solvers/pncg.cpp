// One time step by preconditioned nonlinear conjugate gradients, without a linear system (Shen, Cai, Bi, Lv 2024, "Preconditioned
// Nonlinear Conjugate Gradient Method for Real-time Interior-point Hyperelasticity"; rules also by the authors' public
// source, no code is theirs). An iteration:
//
//   1 assemble gradient g and matrix H at x, with the contacts there and every element clamped
//   2 p = -P g + beta p, P the inverse of a preconditioner of H: jacobi, its diagonal, as published; beta by dai_kou.hpp, 0 in
//     the first iteration and where it is NaN. E falls along p to first order
//   3 dx = -(g.p / p.Hp) p, which ends in the minimum of the quadratic model along p
//   4 pncg_bound accd: dx is bounded as in line_search, by ACCD and the strain limit, and halved until E falls (Armijo); after
//     one that was bounded beta is 0;
//     half_d_hat, as published: no vertex goes farther than half of the smallest d_hat, without CCD, and E decides nothing; a
//     state that is not feasible is halved, which is ours
//   5 the step is over where the model falls by less than pncg_epsilon of its fall in the first iteration, as published, or by
//     less than the rounding of E
#include <algorithm>
#include <cmath>

#include "core/linear/preconditioner.hpp"
#include "core/math/error.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/newton_system.hpp"
#include "core/newton/step_solver.hpp"
#include "core/step_solvers/dai_kou.hpp"

namespace bb {
namespace {

constexpr double shortest_part = 1e-14;  // of dx; below it x does not move any more
constexpr const char* by_ccd = "accd";
constexpr const char* by_d_hat = "half_d_hat";

class Pncg final : public StepSolver {
 public:
  explicit Pncg(const StepSolverOptions& options)
      : options_(options),
        armijo_(number(options.parameters, "armijo")),
        cap_fraction_(number(options.parameters, "cap_fraction")),
        epsilon_(number(options.parameters, "pncg_epsilon")),
        guarded_(text(options.parameters, "pncg_bound") == by_ccd),
        kind_(text(options.parameters, "pncg_preconditioner")) {}
  std::string_view name() const override { return "pncg"; }

  void require(StepSystem& system) const override { require_on_host(system, name()); }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = start_step(system, task, used);
    p_.resize(0);
    preconditioner_ = make_preconditioner(kind_);  // nothing of a step decides about the next one
    first_fall_ = fall_ = magnitude_ = bounds_ = rises_ = 0;
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      IterationReport report = begin_iteration(system, task.step, iteration);
      find_step(system.on_host(), report);
      report_direction(system, report, observer);
      if (const auto failed = direction_failure(report, false)) {
        finish_iteration(system, step, report, observer);
        fail_step(system, step, *failed, report);
        break;
      }
      step.end_proof = check_end(system, options_.saddle, step, report).proof;
      const bool moved = move(system, report);
      const bool over =
          fall_ <= epsilon_ * first_fall_ || within_rounding({-fall_, magnitude_}, system.view().precision());
      finish_iteration(system, step, report, observer);
      if (moved) show_motion(system, task.step, observer);
      if (over) {
        step.status = StepStatus::converged;
        break;
      }
      if (!moved) {
        step.status = StepStatus::line_search_failed;
        step.detail = describe_bound(system);
        break;
      }
    }
    step.solver.values = {{"pncg_bounds", bounds_},
                          {"pncg_rises", rises_},
                          {"pncg_fall", first_fall_ > 0 ? fall_ / first_fall_ : 0}};
    return step;
  }

 private:
  // 2 and 3. The matrix is that of assemble(). A gradient of 0 leads nowhere: dx = 0, and the step is over.
  void find_step(NewtonSystem& system, IterationReport& report) {
    const ScopedPhase timer(system.clock(), Phase::linear_solve);
    Diagnosis& at = system.diagnosis();
    const ReducedSystem& h = at.solved();
    before_.swap(g_);
    at.blocks().restrict_vector(at.gradient(), g_);
    product_.update(h);
    LinearReport& linear = report.solve.linear;
    linear.status = product_.all_finite() && g_.allFinite() ? preconditioner_->setup(h, product_)
                                                            : LinearStatus::non_finite;
    linear.detail = preconditioner_->detail();
    Positions dx = Positions::Zero(3, system.view().x().cols());
    fall_ = 0;
    if (linear.status == LinearStatus::ok && g_.squaredNorm() > 0) {
      turn();
      product_.multiply(p_, hp_);
      const double slope = g_.dot(p_), part = -slope / p_.dot(hp_);
      p_ *= part;
      fall_ = -slope * part / 2;
      first_fall_ = std::max(first_fall_, report.iteration == 0 ? fall_ : 0);
      at.blocks().expand_vector(p_, dx);
    }
    system.set_direction(dx);
  }

  // The next p, from the last dx: beta p does not depend on the length of p.
  void turn() {
    preconditioner_->apply(g_, pg_);
    if (p_.size() == g_.size()) {
      const VecXd y = g_ - before_;
      preconditioner_->apply(y, py_);
      const double beta = dai_kou(g_, y, py_, p_);
      p_ = std::isfinite(beta) ? VecXd(beta * p_ - pg_) : VecXd(-pg_);
    } else {
      p_ = -pg_;
    }
  }

  // 4. Whether x is another one.
  bool move(StepSystem& system, IterationReport& report) {
    system.prepare_motion(MotionEnd::on_target, guarded_);
    double bound = 1;
    if (guarded_) {
      bound = system.bound_motion(report);
    } else if (const auto& d_hat = system.view().scene().d_hat; !d_hat.empty()) {
      const double farthest = system.direction_size().vertex_m;
      const double allowed = *std::min_element(d_hat.begin(), d_hat.end()) / 2;
      if (farthest > allowed) bound = allowed / farthest;
    }
    bounds_ += bound < 1;
    // with what led into a contact the next motions would press it together
    if (guarded_ && bound < 1) p_.resize(0);
    for (double part = guarded_ && bound < 1 ? cap_fraction_ * bound : bound; part > shortest_part;
         part /= 2) {
      ++report.line_search_trials;
      const auto change = system.try_motion(part);
      if (!change) continue;
      magnitude_ = change->magnitude;
      const bool falls = change->change <= -armijo_ * part * 2 * report.decrement_J;
      report.rounding_accepts = guarded_ && !falls && within_rounding(*change, system.view().precision());
      if (guarded_ && !falls && !report.rounding_accepts) continue;
      report.alpha = part;
      report.energy_change_J = change->change;
      rises_ += change->change > 0 && !within_rounding(*change, system.view().precision());
      system.accept();
      return true;
    }
    return false;
  }

  StepSolverOptions options_;
  double armijo_, cap_fraction_, epsilon_;
  bool guarded_;
  std::string kind_;
  std::unique_ptr<Preconditioner> preconditioner_;
  SymmetricProduct product_;
  VecXd g_, before_, pg_, py_, p_, hp_;               // free degrees of freedom; p_ empty: none before
  double first_fall_ = 0, fall_ = 0, magnitude_ = 0;  // J, of the model at its minimum along p; of E
  double bounds_ = 0, rises_ = 0;
};

}  // namespace

StepSolverEntry step_solver_pncg() {
  StepSolverEntry entry;
  entry.guarantee =
      "with pncg_bound accd no surface passes through another and no strain reaches its limit, in the motion "
      "of any iteration; with half_d_hat, as published, none: what is nearer than d_hat may pass through "
      "each other within an iteration, and only the audit reports it; how far the end of a step is from the "
      "solution is not computed, a step that reaches max_iterations ends the run";
  entry.parameters = {
      {"armijo", open_high(open_low(number_in(0, 0.5, "1"))), 1e-4, "sufficient decrease"},
      {"cap_fraction", open_low(number_in(0, 1, "1")), 0.8,
       "part of a binding contact or strain bound that is taken; 1 goes to the stop level"},
      {"pncg_bound", word({by_ccd, by_d_hat}), by_ccd,
       "what an iteration is bounded by: ACCD, strain limit and Armijo, or half of d_hat a vertex alone "
       "(Shen "
       "et al. 2024)"},
      {"pncg_preconditioner", word({"none", "jacobi", "block_jacobi", "ic0"}), "jacobi",
       "preconditioner of the gradient, of the matrix of every iteration; jacobi as published"},
      {"pncg_epsilon", open_high(number_in(0, 1, "1")), 1e-4,
       "a step is over when its model falls by less than this part of its first fall (Shen et al. 2024: 1e-3 "
       "to 1e-10)"},
  };
  entry.stated_always = false;
  entry.counters = {
      {"pncg_bounds", "pncg: iterations whose motion pncg_bound ended", OverSteps::sum},
      {"pncg_rises", "pncg: iterations in which E grew, which half_d_hat lets happen", OverSteps::sum},
      {"pncg_fall", "pncg: fall of the model in the last iteration of a step, in that of its first",
       OverSteps::largest},
  };
  entry.needs.minimum = false;
  entry.asked_to_converge = false;
  entry.settings.clamped = entry.settings.unmoved = true;
  entry.settings.unbounded = [](const ParameterMap& complete) {
    return text(complete, "pncg_bound") != by_ccd;
  };
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<Pncg>(options);
  };
  return entry;
}

}  // namespace bb
