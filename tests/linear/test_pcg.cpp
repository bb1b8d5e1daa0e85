// Conjugate gradients: preconditioners against a dense solution, every cause of failure
// provoked, Ritz values.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/linear/cg_ritz.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::pcg_test {
namespace {

std::unique_ptr<LinearSolver> pcg(const std::string& preconditioner, double tol, int cap = 10000) {
  LinearOptions options;
  options.name = "pcg";
  options.parameters = {
      {"preconditioner", preconditioner}, {"forcing", "fixed"}, {"tol_rel", tol}, {"max_iterations", cap}};
  return make_linear_solver(options);
}

TEST(Pcg, EveryPreconditionerMeetsTheDenseSolution) {
  const ReducedSystem system = grid_system(12, 1e-2, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  const VecXd truth = test::solve(dense(system), b);
  std::vector<int> iterations;
  for (const std::string& name : preconditioners().names()) {
    VecXd x;
    const LinearReport report = pcg(name, 1e-11)->solve(system, b, x);
    EXPECT_EQ(report.status, LinearStatus::ok) << name;
    EXPECT_LT((x - truth).norm(), 1e-8 * truth.norm()) << name;
    EXPECT_LE(report.residual_true, 1e-11);
    EXPECT_NEAR(report.residual_true, (b - dense(system) * x).norm() / b.norm(), 1e-14);
    EXPECT_GT(report.residual_recurrence, 0);
    EXPECT_LE(report.residual_recurrence, 1e-11);
    iterations.push_back(report.iterations);
  }
  EXPECT_LT(iterations[3], iterations[0] / 2);  // ic0 against none
  EXPECT_LT(iterations[2], iterations[0]);      // block_jacobi against none
  EXPECT_LT(iterations[4], iterations[2]);      // schwarz against block_jacobi
}

TEST(Pcg, ThreadsDoNotChangeABit) {
  const ReducedSystem system = grid_system(70, 1e-2, 1);  // 14,700 unknowns: several chunks
  const VecXd b = random_vector(system.lower.rows(), 2);
  std::vector<VecXd> solutions;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    solutions.emplace_back();
    EXPECT_EQ(pcg("block_jacobi", 1e-6)->solve(system, b, solutions.back()).status, LinearStatus::ok);
  }
  EXPECT_EQ(solutions[0], solutions[1]);
  EXPECT_EQ(solutions[0], solutions[2]);
  EXPECT_GT(solutions[0].norm(), 0);
}

TEST(Pcg, IndefiniteMatrixIsNamed) {
  VecXd s = spectrum("geometric", 60, 1e2);
  s[0] = -0.004;
  const ReducedSystem system = from_dense(with_spectrum(s, 3));
  ASSERT_GT(dense(system).diagonal().minCoeff(), 0);
  for (const std::string name : {"none", "jacobi"}) {
    VecXd x;
    EXPECT_EQ(pcg(name, 1e-10)->solve(system, random_vector(60, 1), x).status,
              LinearStatus::matrix_indefinite);
  }
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(9, 9);
  a(4, 4) = -1;
  for (const std::string& name : preconditioners().names()) {
    VecXd x;
    EXPECT_EQ(pcg(name, 1e-10)->solve(from_dense(a), VecXd::Ones(9), x).status,
              LinearStatus::matrix_indefinite)
        << name;
  }
}

TEST(Pcg, SingularBlockIsThePreconditionersFault) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(6, 6);
  a.topLeftCorner<3, 3>().setOnes();  // positive semi-definite, rank one
  VecXd x;
  EXPECT_EQ(pcg("block_jacobi", 1e-10)->solve(from_dense(a), VecXd::Ones(6), x).status,
            LinearStatus::preconditioner_indefinite);
  EXPECT_EQ(pcg("none", 1e-10)->solve(from_dense(a), VecXd::Ones(6), x).status, LinearStatus::ok);
}

/// Without a diagonal block no preconditioner that needs it, and a message that says whose it is.
TEST(Pcg, ZeroDiagonalBlockIsNamed) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(9, 9);
  a.block<3, 3>(3, 3).setZero();
  int n = 0;
  for (const std::string& name : preconditioners().names()) {
    if (name == "none") continue;
    ReducedSystem system = from_dense(a);
    VecXd x;
    LinearReport report = pcg(name, 1e-10)->solve(system, VecXd::Ones(9), x);
    EXPECT_EQ(report.status, LinearStatus::preconditioner_indefinite) << name;
    EXPECT_NE(report.detail.find("block row 1 is 0"), std::string::npos) << name << ": " << report.detail;
    EXPECT_NE(report.detail.find(name + " needs"), std::string::npos) << name << ": " << report.detail;
    system.block_vertex = {4, 17, 30};
    report = pcg(name, 1e-10)->solve(system, VecXd::Ones(9), x);
    EXPECT_NE(report.detail.find("vertex 17 is 0"), std::string::npos) << name << ": " << report.detail;
    EXPECT_EQ(pcg(name, 1e-10)->solve(grid_system(3, 1), VecXd::Ones(27), x).detail, "");
    ++n;
  }
  EXPECT_GE(n, 3);
}

TEST(Pcg, SemiDefiniteMatrixIsNotCalledIndefinite) {
  VecXd s = spectrum("geometric", 60, 1e2);
  s.head(3).setZero();
  const ReducedSystem system = from_dense(with_spectrum(s, 3));
  VecXd x;
  const LinearReport report = pcg("none", 1e-14, 500)->solve(system, random_vector(60, 1), x);
  EXPECT_TRUE(report.status == LinearStatus::tolerance_below_rounding ||
              report.status == LinearStatus::iteration_cap)
      << to_string(report.status);
  EXPECT_GT(report.residual_true, 1e-3);  // the right-hand side is not in the range
}

TEST(Pcg, ToleranceBelowRoundingIsNamed) {
  const ReducedSystem system = from_dense(with_spectrum(spectrum("geometric", 80, 1e8), 3));
  VecXd x;
  const LinearReport report = pcg("none", 1e-17)->solve(system, random_vector(80, 1), x);
  EXPECT_EQ(report.status, LinearStatus::tolerance_below_rounding);
  EXPECT_GT(report.residual_true, 1e-17);
  EXPECT_LT(report.residual_true, 1e-6);
  EXPECT_GT(report.restarts, 0);
}

TEST(Pcg, CapAndNonFiniteAreNamed) {
  const ReducedSystem system = grid_system(12, 1e-2, 1);
  VecXd b = random_vector(system.lower.rows(), 2), x;
  LinearReport report = pcg("jacobi", 1e-12, 5)->solve(system, b, x);
  EXPECT_EQ(report.status, LinearStatus::iteration_cap);
  EXPECT_EQ(report.iterations, 5);
  EXPECT_NEAR(report.residual_true, report.residual_recurrence, 1e-12);
  b[7] = std::nan("");
  EXPECT_EQ(pcg("jacobi", 1e-12)->solve(system, b, x).status, LinearStatus::non_finite);
  ReducedSystem bad = system;
  bad.lower.valuePtr()[40] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(pcg("ic0", 1e-12)->solve(bad, VecXd::Ones(b.size()), x).status, LinearStatus::non_finite);
}

TEST(Pcg, BrokenIncompleteFactorIsShiftedAndCounted) {
  // Kershaw's matrix (1978): positive definite, incomplete Cholesky breaks down.
  Eigen::MatrixXd a(4, 4);
  a << 3, -2, 0, 2, -2, 3, -2, 0, 0, -2, 3, -2, 2, 0, -2, 3;
  ASSERT_GT(test::eigenvalues(a)[0], 0);
  ReducedSystem system = from_dense(a);
  VecXd x;
  const LinearReport report = pcg("ic0", 1e-12)->solve(system, VecXd::Ones(4), x);
  EXPECT_EQ(report.status, LinearStatus::ok);
  EXPECT_GT(report.preconditioner_shifts, 0);
  EXPECT_GT(report.preconditioner_shift, 0);
  EXPECT_LT((a * x - VecXd::Ones(4)).norm(), 1e-11);
  EXPECT_EQ(pcg("ic0", 1e-12)->solve(grid_system(4, 1, 1), VecXd::Ones(48), x).preconditioner_shifts, 0);
}

TEST(Pcg, IncompleteFactorIsExactWithoutFill) {
  // A tridiagonal matrix loses nothing: one step.
  Eigen::MatrixXd a = 2.1 * Eigen::MatrixXd::Identity(40, 40);
  a.diagonal(1).setConstant(-1);
  a.diagonal(-1).setConstant(-1);
  VecXd x;
  EXPECT_EQ(pcg("ic0", 1e-12)->solve(from_dense(a), random_vector(40, 1), x).iterations, 1);
  EXPECT_GT(pcg("jacobi", 1e-12)->solve(from_dense(a), random_vector(40, 1), x).iterations, 5);
}

TEST(Pcg, RitzValuesMeetTheEndsOfTheSpectrum) {
  for (const std::string name : {"none", "jacobi", "block_jacobi"}) {
    const ReducedSystem system = grid_system(7, 1e-2, 1);
    const Eigen::MatrixXd a = dense(system);
    Eigen::MatrixXd d = Eigen::MatrixXd::Identity(a.rows(), a.cols());
    if (name == "jacobi") d = a.diagonal().asDiagonal();
    for (int v = 0; name == "block_jacobi" && v < a.rows(); v += 3) d.block<3, 3>(v, v) = a.block<3, 3>(v, v);
    const VecXd truth = test::eigenvalues(a, d);
    VecXd x;
    const LinearReport report = pcg(name, 1e-13)->solve(system, random_vector(a.rows(), 5), x);
    EXPECT_NEAR(report.ritz_min / truth[0], 1, 1e-3) << name;
    EXPECT_NEAR(report.ritz_max / truth[truth.size() - 1], 1, 1e-3) << name;
    EXPECT_GE(report.ritz_min, truth[0] * (1 - 1e-10));
    EXPECT_LE(report.ritz_max, truth[truth.size() - 1] * (1 + 1e-10));
  }
}

TEST(CgRitz, MeetsTheDenseTridiagonalMatrix) {
  const std::vector<double> alpha = {0.5, 2e3, 1.5, 40, 0.01, 7}, beta = {0.3, 1e-4, 2, 0.7, 0.2};
  test::MatXl t = test::MatXl::Zero(6, 6);
  for (int j = 0; j < 6; ++j) {
    const auto k = static_cast<std::size_t>(j);
    t(j, j) = 1.0L / alpha[k] + (j > 0 ? static_cast<long double>(beta[k - 1]) / alpha[k - 1] : 0);
    if (j < 5) t(j + 1, j) = t(j, j + 1) = std::sqrt(static_cast<long double>(beta[k])) / alpha[k];
  }
  const test::VecXl eigen = test::eigenvalues(t);
  const RitzExtremes ritz = cg_ritz_extremes(alpha, beta);
  EXPECT_NEAR(ritz.min / static_cast<double>(eigen[0]), 1, 1e-11);
  EXPECT_NEAR(ritz.max / static_cast<double>(eigen[5]), 1, 1e-11);
  EXPECT_GT(ritz.max / ritz.min, 1e3);
  EXPECT_EQ(cg_ritz_extremes({}, {}).max, 0);
  EXPECT_NEAR(cg_ritz_extremes({0.25}, {}).min, 4, 1e-11);
}

}  // namespace
}  // namespace bb::pcg_test
