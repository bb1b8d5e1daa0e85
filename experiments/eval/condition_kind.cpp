// condition: extreme eigenvalues of a sparse symmetric matrix, by the estimators of the diagnose pass.
#include <limits>
#include <random>

#include "core/linear/condition.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/eval/kinds.hpp"

namespace bb::eval {
namespace {

constexpr int kLargestIndex = 999'999;  // keeps a mistyped index from requesting all memory
constexpr int kLargestDense = 3000;     // the estimator dense is for tests

ReducedSystem system_field(Query& q) {
  const std::vector<int> rows = q.indices("rows", kLargestIndex), cols = q.indices("cols", kLargestIndex);
  const std::vector<double> values =
      q.list("values", rows.empty() ? -1 : static_cast<int>(rows.size()), kFinite);
  ReducedSystem system;
  if (q.wrong()) return system;
  if (rows.size() != cols.size()) {
    q.complain("cols", std::to_string(cols.size()) + " indices",
               "as many as rows: " + std::to_string(rows.size()));
    return system;
  }
  int n = 0;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] < cols[k]) {
      q.complain("cols/" + std::to_string(k), std::to_string(cols[k]) + " in row " + std::to_string(rows[k]),
                 "the lower triangle: column <= row");
      return system;
    }
    n = std::max(n, rows[k] + 1);
    entries.emplace_back(rows[k], cols[k], values[k]);
  }
  system.lower.resize(n, n);
  system.lower.setFromTriplets(entries.begin(), entries.end());
  for (int i = 0; i < n; i += 3) system.block_start.push_back(i);
  system.block_start.push_back(n);
  system.pattern_id = 1;
  return system;
}

/// ritz: Ritz values out of the PCG that the pipeline solves with, on a seeded right-hand side.
ConditionEstimate ritz_estimate(const ReducedSystem& system, Scaling scaling) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  VecXd b(system.lower.rows()), x;
  for (double& v : b) v = normal(random);
  LinearOptions options;
  options.name = "pcg";
  options.parameters["preconditioner"] = std::string(to_string(scaling));
  options.parameters["forcing"] = std::string("fixed");
  const LinearReport report = make_linear_solver(options)->solve(system, b, x);
  ConditionEstimate out = condition_from_ritz(report.ritz_min, report.ritz_max);
  if (report.status == LinearStatus::matrix_indefinite) {
    out.status = ConditionStatus::not_pd;
    out.cond = std::numeric_limits<double>::quiet_NaN();  // a ratio of positive Ritz values bounds nothing
  }
  return out;
}

ConditionEstimate estimate(const ReducedSystem& system, Scaling scaling, Estimator estimator) {
  if (estimator == Estimator::ritz) return ritz_estimate(system, scaling);
  ConditionOptions options;
  options.estimator = estimator;
  options.scaling = scaling;
  return ConditionEstimator().estimate(system, options);
}

}  // namespace

template <class T>
Answer answer::condition(Query& q) {
  const ReducedSystem system = system_field(q);
  const std::string scaling = q.choice("scaling", {"none", "jacobi", "block_jacobi"});
  const auto estimator = static_cast<Estimator>(q.integer("tier", 0, 4));
  if (estimator == Estimator::dense && system.lower.rows() > kLargestDense) {
    q.complain("tier", "3 on " + std::to_string(system.lower.rows()) + " rows",
               "another estimator, or at most " + std::to_string(kLargestDense) + " rows");
  }
  q.finish();
  const ConditionEstimate e = estimate(system,
                                       scaling == "none"     ? Scaling::none
                                       : scaling == "jacobi" ? Scaling::jacobi
                                                             : Scaling::block_jacobi,
                                       estimator);
  Answer a;
  a.number("lambda_min", e.lambda_min);
  a.number("lambda_max", e.lambda_max);
  a.number("cond", e.cond);
  a.word("method", e.method);
  a.status(to_string(e.status));
  return a;
}

BB_EVAL_KIND(condition);

}  // namespace bb::eval
