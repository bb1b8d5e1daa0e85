// The plan of a config: what the options add to the scene's own needs.
#include <gtest/gtest.h>

#include "experiments/config/parse.hpp"
#include "experiments/run/plan.hpp"

namespace bb::plan_of_test {
namespace {

Plan planned(const char* scene, const std::vector<std::string>& overrides) {
  const std::string text =
      std::string(R"({"schema": "barrierbench.config/1", "formulation": "log", "scene": )") + scene + "}";
  const RunConfig config = parse_config(text, "test", ".", overrides);
  return plan_of(config, build_scene(config));
}

constexpr const char* hang = R"({"name": "hang", "n": 3})";

TEST(PlanOf, AsksThePoliciesWhetherTheyReadTheElasticMatrix) {
  const std::string dynamic = "/formulation=cubic_dynamic",
                    mass = "/formulation/stiffness_policy/elastic_term=false";
  const std::string fixed_limit = R"(/strain_limit/stiffness_policy={"name": "fixed", "k_s_N_per_m": 1})";
  EXPECT_FALSE(planned(hang, {}).policy_submatrix.needed);
  EXPECT_TRUE(planned(hang, {dynamic, fixed_limit}).policy_submatrix.needed);
  EXPECT_FALSE(
      planned(hang, {dynamic, mass}).policy_submatrix.needed);  // the limit follows the contact's policy
  const std::string own_limit = R"(/strain_limit/stiffness_policy/elastic_term=true)";
  EXPECT_TRUE(planned(hang, {dynamic, mass, own_limit}).policy_submatrix.needed);
  EXPECT_FALSE(planned(hang, {dynamic, mass, fixed_limit}).policy_submatrix.needed);
  EXPECT_FALSE(planned(hang, {dynamic, mass, "/strain_limit/enabled=false"}).policy_submatrix.needed);
}

TEST(PlanOf, OnlyTheArticlesOwnSolverHasNoStepBound) {
  constexpr const char* common = R"({"name": "drape2d"})";
  constexpr const char* literal = R"({"name": "drape2d", "protocol": "article_literal"})";
  EXPECT_TRUE(planned(common, {}).step_bound.needed);
  EXPECT_FALSE(planned(literal, {R"(/strain_limit/stiffness_policy={"name": "fixed", "k_s_N_per_m": 1})"})
                   .step_bound.needed);
}

TEST(PlanOf, ATraceIsLeftByARunThatIsObserved) {
  EXPECT_TRUE(planned(hang, {}).trace.needed);
  EXPECT_FALSE(planned(hang, {"/passes/audit=false"}).trace.needed);
  EXPECT_TRUE(planned(hang, {"/passes/audit=false", "/output/frames_every=5"}).trace.needed);
  EXPECT_TRUE(planned(hang, {"/passes/audit=false", "/passes/time=false"}).trace.needed);
}

}  // namespace
}  // namespace bb::plan_of_test
