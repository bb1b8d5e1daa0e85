// Whether a matrix is positive definite, by every solver, against its dense spectrum.
#include "core/linear/definiteness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/linear/systems.hpp"

namespace bb::definiteness_test {
namespace {

using Verdict = Definiteness::Verdict;

std::vector<std::string> solvers_here() {
  std::vector<std::string> out;
  for (const LinearSolverEntry& entry : linear_solvers()) {
    if (missing_for(entry.name).empty()) out.push_back(entry.name);
  }
  return out;
}

class DefinitenessOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, DefinitenessOf, testing::ValuesIn(solvers_here()),
                         [](const auto& one) { return one.param; });

TEST_P(DefinitenessOf, random_matrices_is_that_of_their_spectrum) {
  int negative = 0, positive = 0;
  for (unsigned seed = 1; seed <= 16; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> decade(-3, 2);
    const int n = 30;
    Eigen::VectorXd spectrum(n);
    for (int i = 0; i < n; ++i) spectrum[i] = std::pow(10, decade(random));
    const int n_negative = static_cast<int>(seed % 4);  // 0 to 3
    for (int i = 0; i < n_negative; ++i) spectrum[i] = -std::pow(10, decade(random));
    const ReducedSystem a = from_dense(with_spectrum(spectrum, seed));
    const ReducedSystem near = from_dense(with_spectrum(spectrum.cwiseAbs(), seed));
    LinearOptions options;
    options.name = GetParam();
    const Definiteness found =
        make_linear_solver(options)->examine(a, [&near]() -> const ReducedSystem& { return near; });
    ASSERT_EQ(found.verdict, n_negative == 0 ? Verdict::positive : Verdict::negative) << seed;
    EXPECT_GT(found.factorizations + found.iterations, 0);
    if (found.verdict == Verdict::positive) {
      ++positive;
      continue;
    }
    ++negative;
    const VecXd image = a.lower.selfadjointView<Eigen::Lower>() * found.direction;
    const double curvature = found.direction.dot(image) / found.direction.squaredNorm();
    EXPECT_LT(found.curvature, 0) << seed;
    EXPECT_NEAR(found.curvature, curvature, 1e-9 * std::abs(curvature)) << seed;
    EXPECT_GE(found.curvature, spectrum.minCoeff() * (1 + 1e-9)) << seed;
    EXPECT_LE(found.curvature, 0.9 * spectrum.minCoeff()) << seed;  // improved
  }
  EXPECT_EQ(positive, 4);
  EXPECT_EQ(negative, 12);
}

/// One small negative eigenvalue among large ones, as a saddle that is hardly one has.
TEST_P(DefinitenessOf, a_small_negative_eigenvalue_is_seen) {
  Eigen::VectorXd spectrum = Eigen::VectorXd::LinSpaced(30, 1, 100);
  for (const double smallest : {-1e-3, -1e-6, 1e-6}) {
    spectrum[0] = smallest;
    const ReducedSystem a = from_dense(with_spectrum(spectrum, 3));
    const ReducedSystem near = from_dense(with_spectrum(spectrum.cwiseAbs(), 3));
    LinearOptions options;
    options.name = GetParam();
    const Definiteness found =
        make_linear_solver(options)->examine(a, [&near]() -> const ReducedSystem& { return near; });
    EXPECT_EQ(found.verdict, smallest < 0 ? Verdict::negative : Verdict::positive) << smallest;
  }
}

/// What a solve has set up answers for its own matrix alone, and only conjugate gradients have set up anything.
TEST(DefinitenessOfWhatWasSolved, is_that_of_its_spectrum) {
  LinearOptions options;
  options.name = "pcg";
  const auto solver = make_linear_solver(options);
  EXPECT_FALSE(solver->examine_solved()) << "nothing was solved";
  for (const double smallest : {1e-3, -1e-3}) {
    Eigen::VectorXd spectrum = Eigen::VectorXd::LinSpaced(30, 1, 100);
    spectrum[0] = smallest;
    const ReducedSystem a = from_dense(with_spectrum(spectrum, 3));
    VecXd x, b = VecXd::Ones(30);
    solver->solve(a, b, x);
    const std::optional<Definiteness> found = solver->examine_solved();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->verdict, smallest < 0 ? Verdict::negative : Verdict::positive);
    EXPECT_GT(found->iterations, 1);
    solver->examine(a, [&a]() -> const ReducedSystem& { return a; });
    EXPECT_FALSE(solver->examine_solved()) << "what is set up is of an examination";
    solver->solve(a, VecXd::Zero(30), x);
    EXPECT_FALSE(solver->examine_solved()) << "nothing is set up for a right-hand side of zeros";
  }
}

TEST_P(DefinitenessOf, what_is_no_number_is_unknown) {
  Eigen::MatrixXd full = Eigen::MatrixXd::Identity(6, 6);
  full(2, 2) = std::nan("");
  const ReducedSystem a = from_dense(full);
  LinearOptions options;
  options.name = GetParam();
  EXPECT_EQ(make_linear_solver(options)->examine(a, [&a]() -> const ReducedSystem& { return a; }).verdict,
            Verdict::unknown);
}

}  // namespace
}  // namespace bb::definiteness_test
