// The registry: every solver meets a dense solution, unknown names are refused with a hint.
#include "core/linear/linear_solver.hpp"

#include <gtest/gtest.h>

#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::linear_solver_test {
namespace {

TEST(LinearSolver, EverySolverOfTheRegistryMeetsTheDenseSolution) {
  const ReducedSystem system = grid_system(8, 0.1, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  const VecXd truth = test::solve(dense(system), b);
  ASSERT_GE(linear_solvers().size(), 2u);
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (!missing_for(entry.name).empty()) continue;  // tests/standin/cudss
    LinearOptions options;
    options.name = entry.name;
    options.parameters["forcing"] = std::string("fixed");
    options.parameters["tol_rel"] = 1e-12;
    const auto solver = make_linear_solver(options);
    VecXd x;
    const LinearReport report = solver->solve(system, b, x);
    EXPECT_EQ(solver->name(), entry.name);
    EXPECT_FALSE(entry.doc.empty());
    EXPECT_EQ(report.status, LinearStatus::ok) << entry.name;
    EXPECT_LT((x - truth).norm(), 1e-10 * truth.norm()) << entry.name;
    EXPECT_LT(report.residual_true, 1e-12);
    for (const double scale : {1e-9, 1e9}) {  // a residual is relative: it does not know the unit of forces
      VecXd scaled;
      const LinearReport same = solver->solve(system, scale * b, scaled);
      EXPECT_NEAR(same.residual_true, (scale * b - dense(system) * scaled).norm() / (scale * b.norm()),
                  1e-14);
      EXPECT_LT(same.residual_true, 1e-12) << entry.name;
      EXPECT_GT(same.residual_true, 1e-20) << entry.name;
    }
    VecXd zero;
    EXPECT_EQ(solver->solve(system, VecXd::Zero(b.size()), zero).status, LinearStatus::ok);
    EXPECT_EQ(zero, VecXd::Zero(b.size()));
    EXPECT_EQ(solver->solve(from_dense(Eigen::MatrixXd(0, 0)), VecXd(0), zero).status, LinearStatus::ok);
    EXPECT_THROW(solver->solve(system, VecXd::Zero(3), zero), ConfigError);
  }
}

std::string message(const LinearOptions& options) {
  try {
    make_linear_solver(options);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(LinearSolver, UnknownNamesAreListedWithTheNearest) {
  LinearOptions options;
  options.name = "cholmid";
  EXPECT_EQ(message(options),
            "/linear_solver/name: found \"cholmid\"; allowed: one of cholmod, cudss, lagged_cholesky, pcg, "
            "pcg_resident (did you mean cholmod?)");
  options.name = "multigrid";
  EXPECT_EQ(message(options),
            "/linear_solver/name: found \"multigrid\"; allowed: one of cholmod, cudss, lagged_cholesky, pcg, "
            "pcg_resident");
  options = {};
  options.name = "pcg";
  options.parameters["preconditioner"] = "block-jacobi";
  EXPECT_NE(message(options).find("(did you mean block_jacobi?)"), std::string::npos);
}

TEST(LinearSolver, SaysWhereItWantsTheMatrix) {
  for (const LinearSolverEntry& entry : linear_solvers()) {
    const MatrixPlace place = entry.name == "cudss"          ? MatrixPlace::card
                              : entry.name == "pcg_resident" ? MatrixPlace::executor
                                                             : MatrixPlace::host;
    EXPECT_EQ(entry.matrix, place) << entry.name;
    EXPECT_EQ(linear_solver_at(place).matrix, place);
    EXPECT_TRUE(place == MatrixPlace::card || missing_for(entry.name).empty()) << entry.name;
  }
  EXPECT_EQ(linear_solver_at(MatrixPlace::executor).name, "pcg_resident");
  EXPECT_EQ(missing_for("no such solver"), "");
}

TEST(LinearSolver, IsRefusedWhereSomethingOfItIsMissing) {
  LinearOptions options;
  options.name = "cudss";
  const std::string missing = missing_for("cudss");
  if (missing.empty()) GTEST_SKIP() << "cudss runs here";
  EXPECT_EQ(message(options), "/linear_solver/name: found \"cudss\"; allowed: another solver: " + missing);
}

TEST(LinearSolver, EveryStatusHasItsWord) {
  std::vector<std::string_view> words;
  for (int k = 0; k <= static_cast<int>(LinearStatus::iteration_cap); ++k) {
    words.push_back(to_string(static_cast<LinearStatus>(k)));
    EXPECT_FALSE(words.back().empty());
  }
  std::sort(words.begin(), words.end());
  EXPECT_EQ(std::unique(words.begin(), words.end()), words.end());
}

}  // namespace
}  // namespace bb::linear_solver_test
