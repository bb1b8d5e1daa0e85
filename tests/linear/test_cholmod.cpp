// The sparse Cholesky factor: reuse of the analysis, causes of failure, the BLAS behind it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <filesystem>

#include "core/linear/blas_info.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::cholmod_test {
namespace {

TEST(Cholmod, AnalysisStaysWhileThePatternStays) {
  LinearOptions options;
  const auto solver = make_linear_solver(options);
  ReducedSystem system = grid_system(10, 0.5, 17);
  const VecXd b = random_vector(system.lower.rows(), 1);
  VecXd x;
  LinearReport report = solver->solve(system, b, x);
  EXPECT_TRUE(report.analyzed && report.factorized);
  EXPECT_GT(report.analyze_s, 0);
  EXPECT_GT(report.factor_s, 0);

  system.lower.coeffs() *= 3;
  report = solver->solve(system, b, x);
  EXPECT_FALSE(report.analyzed);
  EXPECT_TRUE(report.factorized);
  EXPECT_EQ(report.analyze_s, 0);
  EXPECT_LT((x - test::solve(dense(system), b)).norm(), 1e-11 * x.norm());

  const ReducedSystem other = grid_system(9, 0.5, 18);
  report = solver->solve(other, random_vector(other.lower.rows(), 1), x);
  EXPECT_TRUE(report.analyzed);
  EXPECT_LT(report.residual_true, 1e-12);
  for (int round = 0; round < 2; ++round) {  // id 0: unknown, never reused
    EXPECT_TRUE(solver->solve(grid_system(9, 0.5, 0), random_vector(243, 1), x).analyzed);
  }
}

TEST(Cholmod, ReusesItsFactorBitForBit) {
  const ReducedSystem system = grid_system(20, 0.1, 5);
  const VecXd b = random_vector(system.lower.rows(), 3);
  CholmodFactor factor, fresh;
  VecXd first, second, third;
  ASSERT_EQ(factor.factorize(system), LinearStatus::ok);
  factor.solve(b, first);
  factor.solve(random_vector(b.size(), 4), second);
  ASSERT_EQ(factor.factorize(system), LinearStatus::ok);
  factor.solve(b, second);
  ASSERT_EQ(fresh.factorize(system), LinearStatus::ok);
  fresh.solve(b, third);
  EXPECT_EQ(first, second);
  EXPECT_EQ(first, third);
  EXPECT_GT(first.norm(), 0);
  EXPECT_GT(factor.factor_nonzeros(), static_cast<double>(system.lower.nonZeros()));
  EXPECT_GT(factor.factor_flops(), 0);
}

/// CHOLMOD has OpenMP loops of its own, whose pool would spin beside our threads. Ours are those of TBB.
TEST(Cholmod, StartsNoThread) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto n_threads = [] {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  const ReducedSystem system = grid_system(60, 0.1, 5);
  const auto before = n_threads();
  CholmodFactor factor;
  ASSERT_EQ(factor.factorize(system), LinearStatus::ok);
  EXPECT_EQ(n_threads(), before);
}

TEST(Cholmod, CausesOfFailureAreTold) {
  const auto solver = make_linear_solver({});
  ReducedSystem system = grid_system(6, 0.5, 3);
  const VecXd b = random_vector(system.lower.rows(), 1);
  VecXd x;
  system.lower.coeffRef(50, 50) = -1;
  LinearReport report = solver->solve(system, b, x);
  EXPECT_EQ(report.status, LinearStatus::matrix_indefinite);
  EXPECT_FALSE(report.factorized);
  EXPECT_EQ(x, VecXd::Zero(b.size()));
  system.lower.coeffRef(50, 50) = std::nan("");
  EXPECT_EQ(solver->solve(system, b, x).status, LinearStatus::non_finite);
  system = grid_system(6, 0.5, 3);
  VecXd bad = b;
  bad[4] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(solver->solve(system, bad, x).status, LinearStatus::non_finite);
  EXPECT_EQ(solver->solve(system, b, x).status, LinearStatus::ok);  // and recovers
  EXPECT_LT(report.residual_true, 2);
}

TEST(Cholmod, DiagonalAndTinyMatricesAreOrdered) {
  for (const int n : {1, 2, 7}) {
    const Eigen::MatrixXd a = VecXd::LinSpaced(n, 1, 5).asDiagonal();
    const auto solver = make_linear_solver({});
    VecXd x;
    EXPECT_EQ(solver->solve(from_dense(a), VecXd::Ones(n), x).status, LinearStatus::ok);
    EXPECT_LT((a * x - VecXd::Ones(n)).norm(), 1e-15);
  }
}

TEST(BlasInfo, NamesTheLoadedLibrary) {
  const BlasInfo info = blas_info();
  EXPECT_FALSE(info.dgemm_library.empty());
  EXPECT_FALSE(info.config.empty());
  EXPECT_EQ(info.threads, 1);
  EXPECT_TRUE(info.expected) << info.dgemm_library << " " << info.dpotrf_library << " " << info.parallel;
}

}  // namespace
}  // namespace bb::cholmod_test
