// Linear solvers and condition estimators on the matrix of a chain of springs, whose spectrum is known.
#include <cmath>
#include <numbers>

#include "core/linear/condition.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/validity/block.hpp"

namespace bb {
namespace {

constexpr int n_vertices = 60;

/// tridiag(-1, 2 + shift, -1) on the vertices, the same in each of 3 coordinates: eigenvalues
/// 2 + shift - 2 cos(k pi/(n + 1)), k = 1 .. n, each three times.
ReducedSystem chain(double shift) {
  ReducedSystem out;
  std::vector<Eigen::Triplet<double>> triplets;
  for (int v = 0; v < n_vertices; ++v) {
    for (int c = 0; c < 3; ++c) {
      triplets.emplace_back(3 * v + c, 3 * v + c, 2 + shift);
      if (v > 0) triplets.emplace_back(3 * v + c, 3 * (v - 1) + c, -1);
    }
    out.block_start.push_back(3 * v);
  }
  out.block_start.push_back(3 * n_vertices);
  out.lower.resize(3 * n_vertices, 3 * n_vertices);
  out.lower.setFromTriplets(triplets.begin(), triplets.end());
  return out;
}

double eigenvalue(int k, double shift) {
  const double half = std::sin(k * std::numbers::pi / (2 * (n_vertices + 1)));
  return 4 * half * half + shift;
}

std::vector<LinearOptions> all_solvers() {
  std::vector<LinearOptions> out;
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (!missing_for(entry.name).empty()) continue;
    LinearOptions options{entry.name, {{"forcing", std::string("fixed")}, {"tol_rel", 1e-12}}};
    for (const std::string& preconditioner : preconditioner_choices(entry)) {
      set_preconditioner(entry, preconditioner, options.parameters);
      out.push_back(options);
    }
  }
  return out;
}

}  // namespace

void check_solvers(BlockCheck& check) {
  const ReducedSystem system = chain(0.01);
  VecXd wanted(3 * n_vertices), found;
  for (Eigen::Index i = 0; i < wanted.size(); ++i) wanted[i] = std::sin(0.7 * static_cast<double>(i) + 0.3);
  const VecXd b = system.lower.selfadjointView<Eigen::Lower>() * wanted;
  for (const LinearOptions& options : all_solvers()) {
    const LinearReport report = make_linear_solver(options)->solve(system, b, found);
    const double error = (found - wanted).norm() / wanted.norm();
    check.judge(report.status == LinearStatus::ok ? error : HUGE_VAL,
                options.name + " " + preconditioner_of(options));
  }
}

void check_estimators(BlockCheck& check) {
  for (const double shift : {0.0, 0.01}) {
    const double cond = eigenvalue(n_vertices, shift) / eigenvalue(1, shift);
    for (const Estimator estimator :
         {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
      const ConditionEstimate e = ConditionEstimator().estimate(chain(shift), {.estimator = estimator});
      // inverse_power bounds cond from below, and this spectrum is dense at its upper end
      const double error = estimator == Estimator::inverse_power ? std::max(0.0, e.cond / cond - 1)
                                                                 : std::abs(e.cond / cond - 1);
      check.judge(error, std::string(to_string(estimator)));
      if (estimator == Estimator::inverse_power)
        check.judge(e.cond > 0.5 * cond ? 0 : HUGE_VAL, "inverse_power, half of cond");
    }
  }
}

void check_singular(BlockCheck& check) {
  for (const double shift : {-eigenvalue(1, 0), -0.5}) {  // one eigenvalue 0, in rounding; many below 0
    for (const Estimator estimator :
         {Estimator::inverse_power, Estimator::spectra, Estimator::dense, Estimator::lanczos}) {
      const ConditionEstimate e = ConditionEstimator().estimate(chain(shift), {.estimator = estimator});
      check.judge(e.status == ConditionStatus::ok ? 1 : 0, std::string(to_string(estimator)));
    }
  }
}

}  // namespace bb
