// Tolerances of inexact solves against the formula of Eisenstat and Walker, worked out by hand.
#include "core/linear/forcing.hpp"

#include <gtest/gtest.h>

#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/linear/systems.hpp"

namespace bb::forcing_test {
namespace {

Forcing forcing(const std::string& kind, double tol_rel = 1e-8) {
  return Forcing({{"forcing", kind}, {"tol_rel", tol_rel}});
}

TEST(Forcing, FixedIsTheToleranceItself) {
  Forcing fixed = forcing("fixed", 1e-5);
  for (const double norm : {3.0, 1.0, 1e-9}) EXPECT_EQ(fixed.tolerance(norm), 1e-5);
}

TEST(Forcing, FollowsTheSquareOfTheRatio) {
  Forcing adaptive = forcing("eisenstat_walker");
  EXPECT_EQ(adaptive.tolerance(8), 0.1);
  EXPECT_DOUBLE_EQ(adaptive.tolerance(2), 0.9 / 16);
  EXPECT_DOUBLE_EQ(adaptive.tolerance(0.02), 0.9e-4);
  EXPECT_EQ(adaptive.tolerance(0.06), 0.1);   // the residual grew: no looser than that
  EXPECT_EQ(adaptive.tolerance(6e-9), 1e-8);  // the floor
  EXPECT_EQ(forcing("eisenstat_walker", 1e-3).tolerance(1), 0.1);
}

TEST(Forcing, AnotherAttemptAtOneIterateHasItsTolerance) {
  Forcing adaptive = forcing("eisenstat_walker");
  adaptive.tolerance(8);
  const double once = adaptive.tolerance(2);
  EXPECT_EQ(adaptive.tolerance(2), once);
  EXPECT_LT(once, 0.1);
  EXPECT_DOUBLE_EQ(adaptive.tolerance(1), 0.9 / 4 > 0.1 ? 0.1 : 0.9 / 4);
}

TEST(Forcing, AStepBeginsWithoutMemory) {
  Forcing adaptive = forcing("eisenstat_walker");
  adaptive.tolerance(8);
  EXPECT_LT(adaptive.tolerance(1), 0.1);
  adaptive.begin_step();
  EXPECT_EQ(adaptive.tolerance(0.5), 0.1);
}

TEST(Forcing, PrescribedMotionAsksForMoreAndIsNoResidual) {
  Forcing adaptive = forcing("eisenstat_walker");
  adaptive.tolerance(8);
  EXPECT_EQ(adaptive.tolerance(8000, RightSide::with_motion), 1e-3);
  EXPECT_EQ(adaptive.tolerance(8, RightSide::with_motion), 1e-3);
  EXPECT_EQ(adaptive.tolerance(0.5), 0.1);  // as the first of a step
  EXPECT_EQ(forcing("eisenstat_walker", 0.01).tolerance(8, RightSide::with_motion), 0.01);
  EXPECT_EQ(forcing("fixed", 1e-5).tolerance(8, RightSide::with_motion), 1e-5);
}

/// Every solver that has a forcing solves as far as it says, and not all the way.
TEST(Forcing, SolversStopWhereItSays) {
  const ReducedSystem system = grid_system(14, 1e-2, 1);
  ReducedSystem next = system;
  next.lower.diagonal() *= 1.01;  // for lagged_cholesky
  const VecXd b = random_vector(system.lower.rows(), 2);
  int n = 0;
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (!entry.iterative) continue;
    LinearOptions options;
    options.name = entry.name;
    options.parameters["forcing"] = std::string("eisenstat_walker");
    const auto solver = make_linear_solver(options);
    VecXd x;
    solver->begin_step();
    EXPECT_EQ(solver->solve(system, b, x).tolerance, 0.1) << entry.name;
    const LinearReport report = solver->solve(next, 0.1 * b, x);
    EXPECT_NEAR(report.tolerance, 0.009, 1e-15) << entry.name;
    EXPECT_EQ(report.status, LinearStatus::ok);
    EXPECT_LE(report.residual_true, report.tolerance);
    EXPECT_GT(report.residual_true, 1e-9) << entry.name;
    solver->begin_step();
    EXPECT_EQ(solver->solve(next, 0.1 * b, x).tolerance, 0.1) << entry.name;
    ++n;
  }
  EXPECT_GE(n, 2);
}

}  // namespace
}  // namespace bb::forcing_test
