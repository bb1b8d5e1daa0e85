// The factor of an earlier matrix as preconditioner: when it serves, when it is renewed, and what a matrix
// that is not positive definite does.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::lagged_cholesky_test {
namespace {

std::unique_ptr<LinearSolver> lagged(double tol = 1e-10, int cap = 15) {
  LinearOptions options;
  options.name = "lagged_cholesky";
  options.parameters = {{"forcing", "fixed"}, {"tol_rel", tol}, {"max_pcg_iterations", cap}};
  return make_linear_solver(options);
}

/// The diagonal of every vertex multiplied by a factor of its own.
ReducedSystem with_diagonal(ReducedSystem system, double spread) {
  const VecXd change = random_vector(system.lower.rows(), 9);
  for (Eigen::Index i = 0; i < change.size(); ++i)
    system.lower.coeffRef(i, i) *= 1 + spread * (1 + change[i]);
  return system;
}

TEST(LaggedCholesky, SolvesWithAnEarlierFactor) {
  const ReducedSystem first = grid_system(12, 0.1, 4), second = with_diagonal(first, 0.02);
  const VecXd b = random_vector(first.lower.rows(), 1);
  const auto solver = lagged();
  VecXd x;
  LinearReport report = solver->solve(first, b, x);
  EXPECT_TRUE(report.factorized && report.analyzed);
  EXPECT_LE(report.iterations, 2);
  EXPECT_EQ(report.status, LinearStatus::ok);

  report = solver->solve(second, b, x);
  EXPECT_FALSE(report.factorized || report.analyzed);
  EXPECT_EQ(report.factor_s, 0);
  EXPECT_GT(report.iterations, 2);
  EXPECT_LE(report.iterations, 15);
  EXPECT_LE(report.residual_true, 1e-10);
  EXPECT_LT((x - test::solve(dense(second), b)).norm(), 1e-8 * x.norm());
}

TEST(LaggedCholesky, RenewsAFactorThatServesNoMore) {
  const ReducedSystem first = grid_system(12, 0.1, 4), second = with_diagonal(first, 3);
  const VecXd b = random_vector(first.lower.rows(), 1);
  const auto patient = lagged(1e-10, 200), solver = lagged(1e-10, 6);
  VecXd x;
  patient->solve(first, b, x);
  EXPECT_GT(patient->solve(second, b, x).iterations, 8);

  solver->solve(first, b, x);
  LinearReport report = solver->solve(second, b, x);
  EXPECT_EQ(report.status, LinearStatus::ok);
  EXPECT_TRUE(report.factorized);
  EXPECT_FALSE(report.analyzed);
  EXPECT_GE(report.iterations, 7);  // those in vain are counted too
  EXPECT_LE(report.iterations, 8);
  EXPECT_LT((x - test::solve(dense(second), b)).norm(), 1e-8 * x.norm());
  EXPECT_LE(solver->solve(second, 2 * b, x).iterations, 2);  // with the renewed factor
}

/// Contacts come and go one by one.
TEST(LaggedCholesky, KeepsItsFactorWhereThePatternIsAnother) {
  const auto solver = lagged();
  const ReducedSystem first = grid_system(9, 0.1, 3);
  const VecXd b = random_vector(first.lower.rows(), 1);
  VecXd x;
  EXPECT_TRUE(solver->solve(first, b, x).factorized);
  Eigen::MatrixXd a = dense(first);
  for (const int i : {10, 200}) {  // a stiff pair far apart
    for (const int j : {10, 200}) a(i, j) += i == j ? 40 : -40;
  }
  const ReducedSystem touching = from_dense(a, 4);
  ASSERT_GT(touching.lower.nonZeros(), first.lower.nonZeros());
  const LinearReport report = solver->solve(touching, b, x);
  EXPECT_EQ(report.status, LinearStatus::ok);
  EXPECT_FALSE(report.analyzed || report.factorized);
  EXPECT_LE(report.iterations, 4);  // one direction more than the factor knows
  EXPECT_LT((x - test::solve(a, b)).norm(), 1e-8 * x.norm());

  const ReducedSystem smaller = grid_system(8, 0.1, 5);
  EXPECT_TRUE(solver->solve(smaller, random_vector(smaller.lower.rows(), 1), x).factorized);
}

/// Negative curvature is a proof, so the factor stays; where only a factorisation finds out, it is gone.
TEST(LaggedCholesky, AnIndefiniteMatrixIsNamed) {
  const ReducedSystem good = grid_system(8, 0.5, 3);
  ReducedSystem bad = good;
  bad.lower.coeffRef(50, 50) = -4;
  const VecXd b = random_vector(good.lower.rows(), 1);
  const auto solver = lagged();
  VecXd x;
  LinearReport report = solver->solve(bad, b, x);
  EXPECT_EQ(report.status, LinearStatus::matrix_indefinite);
  EXPECT_TRUE(report.analyzed);
  EXPECT_FALSE(report.factorized);
  EXPECT_EQ(x, VecXd::Zero(b.size()));
  EXPECT_EQ(report.residual_true, 1);
  report = solver->solve(good, b, x);
  EXPECT_EQ(report.status, LinearStatus::ok);
  EXPECT_TRUE(report.factorized);

  report = solver->solve(bad, b, x);
  EXPECT_EQ(report.status, LinearStatus::matrix_indefinite);
  EXPECT_EQ(report.factor_s, 0);
  EXPECT_GT(report.iterations, 0);
  EXPECT_EQ(x, VecXd::Zero(b.size()));
  EXPECT_FALSE(solver->solve(good, b, x).factorized);
  bad.lower.coeffRef(50, 50) = std::nan("");
  EXPECT_EQ(solver->solve(bad, b, x).status, LinearStatus::non_finite);
  EXPECT_FALSE(solver->solve(good, b, x).factorized);
}

TEST(LaggedCholesky, ThreadsDoNotChangeABit) {
  const ReducedSystem first = grid_system(50, 0.1, 4), second = with_diagonal(first, 0.02);
  const VecXd b = random_vector(first.lower.rows(), 1);
  std::vector<VecXd> x;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const auto solver = lagged();
    solver->solve(first, b, x.emplace_back());
    EXPECT_FALSE(solver->solve(second, b, x.back()).factorized);
  }
  EXPECT_EQ(x[0], x[1]);
  EXPECT_EQ(x[0], x[2]);
  EXPECT_GT(x[0].norm(), 0);
}

}  // namespace
}  // namespace bb::lagged_cholesky_test
