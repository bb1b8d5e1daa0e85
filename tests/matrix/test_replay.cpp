// The replay: every solver and estimator has its line, a failure is one, and a singular or indefinite matrix is
// nowhere ok.
#include "experiments/matrix/replay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/matrix/replay_text.hpp"
#include "tests/matrix/stored.hpp"

namespace bb::replay_test {
namespace {

TEST(Replay, EverySolverPreconditionerAndEstimatorHasALine) {
  const Replay r = replay(chain(30, 2.1), {});
  std::set<std::string> solvers, conditioners, of_device;
  for (const ReplayedSolve& row : r.solves) {
    solvers.insert(row.solver);
    if (row.solver == "pcg") conditioners.insert(row.preconditioner);
    if (row.solver == "pcg_resident") of_device.insert(row.preconditioner);
    EXPECT_EQ(row.report.status, LinearStatus::ok) << row.solver << " " << row.preconditioner;
    EXPECT_LE(row.report.residual_true, 1e-8);
    if (row.report.iterative) {
      EXPECT_EQ(row.report.tolerance, 1e-8);
    }
  }
  std::size_t usable = 0;
  for (const std::string& name : linear_solvers().names()) usable += missing_for(name).empty();
  EXPECT_GE(usable, 4U);
  EXPECT_EQ(solvers.size(), usable);
  EXPECT_EQ(conditioners.size(), preconditioners().names().size());
  EXPECT_EQ(of_device, (std::set<std::string>{"block_jacobi", "multilevel_schwarz"}));
  ASSERT_EQ(r.estimates.size(), 15u);  // five estimators, three scalings
  const double pi = std::acos(-1.0), exact = (2.1 + 2 * std::cos(pi / 31)) / (2.1 - 2 * std::cos(pi / 31));
  for (const ReplayedEstimate& row : r.estimates) {
    const bool lower_bound = (row.estimator == Estimator::ritz || row.estimator == Estimator::inverse_power);
    EXPECT_EQ(row.estimate.status, lower_bound ? ConditionStatus::lower_bound : ConditionStatus::ok);
    EXPECT_EQ(row.agreement, row.estimator == Estimator::dense ? Agreement::no_dense
                             : lower_bound                     ? Agreement::bounds
                                                               : Agreement::agrees);
    if (row.estimator != Estimator::ritz && row.estimator != Estimator::inverse_power &&
        row.scaling == Scaling::none) {
      EXPECT_NEAR(row.estimate.cond / exact, 1, 1e-6);
    }
  }
}

TEST(Replay, RowsBeyondTheDenseLimitHaveNoDenseEstimate) {
  const Replay r = replay(chain(30, 2.1), {1e-8, 10000, 29, 1});
  EXPECT_EQ(r.estimates.size(), 12u);
  for (const ReplayedEstimate& row : r.estimates) EXPECT_EQ(row.agreement, Agreement::no_dense);
}

struct Bad {
  const char* name;
  double diagonal;
  int n;
};

TEST(Replay, SingularAndIndefiniteMatricesAreNowhereOk) {
  const double pi = std::acos(-1.0);
  // the eigenvalues of the chain are diagonal - 2 cos(k pi / (n + 1))
  const std::vector<Bad> all{{"singular", 2 * std::cos(pi / 31), 30},
                             {"indefinite", 1.9, 30},
                             {"barely_indefinite", 2 * std::cos(pi / 31) - 1e-9, 30},
                             {"negative", -3, 30}};
  int judged = 0;
  for (const Bad& bad : all) {
    const Replay r = replay(chain(bad.n, bad.diagonal), {});
    for (const ReplayedEstimate& row : r.estimates) {
      EXPECT_NE(row.estimate.status, ConditionStatus::ok)
          << bad.name << " " << to_string(row.estimator) << " " << to_string(row.scaling);
      if (row.estimator != Estimator::ritz) {
        EXPECT_NE(row.agreement, Agreement::differs) << bad.name << " " << to_string(row.estimator);
      }
      ++judged;
    }
  }
  EXPECT_EQ(judged, 60);  // four matrices, five estimators, three scalings
}

ConditionEstimate estimate(ConditionStatus status, double cond, double lambda_min = 1) {
  ConditionEstimate e;
  e.status = status;
  e.cond = cond;
  e.lambda_min = lambda_min;
  e.lambda_max = lambda_min > 0 ? cond * lambda_min : 1;
  return e;
}

TEST(Replay, AgreementKnowsWhatAnEstimateClaims) {
  using S = ConditionStatus;
  const auto verdict = [](const ConditionEstimate& a, const ConditionEstimate& b) { return compare(a, b); };
  const ConditionEstimate dense = estimate(S::ok, 1e6);
  EXPECT_EQ(verdict(estimate(S::ok, 1e6 * (1 + 9e-4)), dense), Agreement::agrees);
  EXPECT_EQ(verdict(estimate(S::ok, 1e6 * (1 + 2e-3)), dense), Agreement::differs);
  EXPECT_EQ(verdict(estimate(S::lower_bound, 1e5), dense), Agreement::bounds);
  EXPECT_EQ(verdict(estimate(S::lower_bound, 2e6), dense), Agreement::differs);
  EXPECT_EQ(verdict(estimate(S::not_pd, NAN), dense), Agreement::differs);
  EXPECT_EQ(verdict(estimate(S::not_converged, NAN), dense), Agreement::differs);
  EXPECT_EQ(verdict(estimate(S::ok, 5e13), estimate(S::ok, 5.2e13)), Agreement::agrees);  // rounding
  EXPECT_EQ(verdict(estimate(S::ok, 4e13), estimate(S::ok, 5e13)), Agreement::differs);
  const ConditionEstimate singular = estimate(S::singular, NAN, 0), negative = estimate(S::not_pd, NAN, -0.1);
  EXPECT_EQ(verdict(estimate(S::ok, 1e6), singular), Agreement::differs);
  EXPECT_EQ(verdict(estimate(S::ok, 1e6), negative), Agreement::differs);
  EXPECT_EQ(verdict(estimate(S::lower_bound, 1e6), singular), Agreement::bounds);
  EXPECT_EQ(verdict(estimate(S::lower_bound, 1e14), singular), Agreement::agrees);
  EXPECT_EQ(verdict(negative, negative), Agreement::agrees);
  EXPECT_EQ(verdict(singular, negative), Agreement::differs);
  EXPECT_EQ(verdict(estimate(S::lower_bound, 1e14), negative), Agreement::differs);
}

TEST(Replay, JsonHasEveryLineOfTheTableAndNullForTheUnknown) {
  StoredSystem stored = chain(30, 1.9);
  const Replay r = replay(stored, {});
  const auto out = replay_json("a.mtx", stored, r);
  EXPECT_EQ(out["solves"].size(), r.solves.size());
  ASSERT_EQ(out["estimates"].size(), r.estimates.size());
  EXPECT_TRUE(out["estimates"].back()["cond"].is_null());
  EXPECT_EQ(out["estimates"].back()["status"], "not_pd");
  const std::string table = replay_table("a.mtx", stored, r);
  EXPECT_NE(table.find("matrix_indefinite"), std::string::npos) << table;
  EXPECT_NE(table.find("no side-car"), std::string::npos) << table;
}

}  // namespace
}  // namespace bb::replay_test
