// How many iterations an earlier factor may take before the present matrix is factorised, and what a solve then counts:
// every cap on either side of what the earlier factor needs, below and above the cap of a fresh factor.
#include <gtest/gtest.h>

#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::lagged_caps_test {
namespace {

constexpr int n_unknowns = 90;

std::unique_ptr<LinearSolver> lagged(int cap, double tol = 1e-8) {
  LinearOptions options;
  options.name = "lagged_cholesky";
  options.parameters = {{"forcing", "fixed"}, {"tol_rel", tol}, {"max_pcg_iterations", cap}};
  return make_linear_solver(options);
}

/// Two matrices of one pattern: the earlier one, and one whose spectrum relative to it spreads over `cond`.
struct Change {
  ReducedSystem first, second;
  VecXd b, x;  // second x = b

  explicit Change(double cond) {
    first = from_dense(with_spectrum(spectrum("linear", n_unknowns, 2), 1));
    second = from_dense(with_spectrum(spectrum("log_uniform", n_unknowns, cond), 2));
    b = random_vector(n_unknowns, 3);
    x = test::solve(dense(second), b);
  }
};

/// Of the second matrix, after the first one was factorised.
LinearReport solve_second(const Change& change, int cap, VecXd& x) {
  const auto solver = lagged(cap);
  EXPECT_TRUE(solver->solve(change.first, change.b, x).factorized);
  return solver->solve(change.second, change.b, x);
}

/// What the earlier factor needs when nothing stops it, and a fresh one.
int needed(const Change& change) {
  VecXd x;
  const LinearReport report = solve_second(change, 100000, x);
  EXPECT_EQ(report.status, LinearStatus::ok);
  EXPECT_FALSE(report.factorized);
  return report.iterations;
}
int needed_afresh(const Change& change) {
  VecXd x;
  return lagged(1)->solve(change.second, change.b, x).iterations;
}

void expect_report(const Change& change, int cap, int earlier, int fresh) {
  VecXd x;
  const LinearReport report = solve_second(change, cap, x);
  ASSERT_EQ(report.status, LinearStatus::ok)
      << "cap " << cap << ", needed " << earlier << ", " << report.detail;
  EXPECT_EQ(report.factorized, cap < earlier) << "cap " << cap << ", needed " << earlier;
  EXPECT_EQ(report.iterations, cap < earlier ? cap + fresh : earlier) << "those in vain count too";
  EXPECT_GE(report.factor_nnz, cap < earlier ? n_unknowns : 0);
  EXPECT_EQ(report.factor_nnz > 0, cap < earlier);
  EXPECT_LE(report.residual_true, 1e-8);
  EXPECT_LT((x - change.x).norm(), 1e-3 * change.x.norm());
}

TEST(LaggedCaps, EveryCapIsKeptAndNoIterationIsForgotten) {
  int below_100 = 0, above_100 = 0;
  for (const double cond : {1.5, 30.0, 1e3, 1e5}) {
    const Change change(cond);
    const int earlier = needed(change), fresh = needed_afresh(change);
    ASSERT_GE(fresh, 1);
    ASSERT_LE(fresh, 5);
    ASSERT_GT(earlier, 2 * fresh);
    for (const int cap : {1, 2, earlier / 2, earlier - 1, earlier, earlier + 1, 2 * earlier}) {
      expect_report(change, cap, earlier, fresh);
      ++(cap > 100 && cap < earlier ? above_100 : below_100);
    }
  }
  EXPECT_GE(above_100, 3);
  EXPECT_GE(below_100, 12);
}

/// A factor that was renewed serves the next solve, whatever the cap of earlier ones.
TEST(LaggedCaps, ARenewedFactorIsTheEarlierOneOfTheNextSolve) {
  const Change change(1e5);
  const int fresh = needed_afresh(change);
  for (const int cap : {fresh, 15, 120}) {
    VecXd x;
    const auto solver = lagged(cap);
    solver->solve(change.first, change.b, x);
    EXPECT_TRUE(solver->solve(change.second, change.b, x).factorized) << cap;
    const LinearReport again = solver->solve(change.second, change.b, x);
    EXPECT_FALSE(again.factorized) << cap;
    EXPECT_EQ(again.iterations, fresh) << cap;
    EXPECT_TRUE(solver->solve(change.first, change.b, x).factorized) << cap;
  }
}

/// A right-hand side that is 0, a tolerance that one iteration meets and a matrix that is the earlier one need no factor.
TEST(LaggedCaps, WhatNeedsNoIterationAsksForNoFactor) {
  const Change change(1e3);
  for (const int cap : {1, 200}) {
    VecXd x;
    const auto solver = lagged(cap, 0.9);
    LinearReport report = solver->solve(change.first, 0 * change.b, x);
    EXPECT_EQ(report.status, LinearStatus::ok);
    EXPECT_FALSE(report.factorized || report.analyzed);
    EXPECT_EQ(report.iterations, 0);
    EXPECT_EQ(x, VecXd::Zero(n_unknowns));
    EXPECT_TRUE(solver->solve(change.first, change.b, x).factorized);
    report = solver->solve(change.first, 2 * change.b, x);
    EXPECT_FALSE(report.factorized);
    EXPECT_EQ(report.iterations, 1);
    EXPECT_GT(x.norm(), 0);
  }
}

/// Rounding that keeps the earlier factor above the tolerance is no reason to give up: a fresh one gets a cap of its own.
TEST(LaggedCaps, AFreshFactorHasItsOwnIterationsWhateverTheEarlierOneTook) {
  int renewed = 0;
  for (const double cond : {1e7, 1e9}) {
    const Change change(cond);
    const int fresh = needed_afresh(change);
    for (const int cap : {20, 99, 100, 101, 150, 300}) {
      VecXd x;
      const LinearReport report = solve_second(change, cap, x);
      ASSERT_EQ(report.status, LinearStatus::ok) << cap << " " << report.detail;
      EXPECT_LE(report.residual_true, 1e-8);
      if (!report.factorized) continue;
      ++renewed;
      EXPECT_LE(report.iterations, cap + fresh) << cap;
      EXPECT_GT(report.iterations, fresh) << cap;
    }
  }
  EXPECT_GE(renewed, 8);
}

}  // namespace
}  // namespace bb::lagged_caps_test
