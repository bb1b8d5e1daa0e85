// linear_solver: auto: which solver it is, and what it leaves as it was.
#include "experiments/run/linear_choice.hpp"

#include <gtest/gtest.h>

#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/plan.hpp"

namespace bb::linear_choice_test {
namespace {

RunConfig decided(const std::string& scene, const std::vector<std::string>& overrides) {
  const std::string text =
      R"({"schema": "barrierbench.config/1", "formulation": "log", "scene": )" + scene + "}";
  RunConfig config = parse_config(text, "test", ".", overrides);
  decide_linear_solver(config);
  return config;
}

std::string hanging(int n) { return R"({"name": "hang", "n": )" + std::to_string(n) + "}"; }

TEST(LinearChoice, GoesByTheNumberOfUnknowns) {
  for (const auto& [n, solver] : {std::pair{18, "lagged_cholesky"}, {19, "pcg"}}) {  // 3 (n^2 - 2) unknowns
    const RunConfig config =
        decided(hanging(n), {"/linear_solver/name=auto", "/linear_solver/max_iterations=77"});
    EXPECT_EQ(free_dofs(build_scene(config)), 3U * (static_cast<unsigned>(n * n) - 2));
    EXPECT_EQ(config.linear_solver.name, solver);
    EXPECT_EQ(integer(config.linear_solver.parameters, "max_iterations"), 77);  // the rest is the config's
    const Plan plan = plan_of(config, build_scene(config));
    EXPECT_EQ(plan.linear.name, solver);
    EXPECT_EQ(plan.preconditioner.needed, n == 19);
    EXPECT_TRUE(plan.linear_solver.reason.starts_with(std::string(solver) + ", by auto: "))
        << plan.linear_solver.reason;
  }
}

/// A planar sheet of n_x x 20 vertices, one of them held or none.
std::string sheet(int n_x, bool held) {
  return R"({"name": "bodies", "planar": true, "bodies": [{"name": "sheet", "mesh": {"generator": "grid", "n_x": )" +
         std::to_string(n_x) + R"(, "n_y": 20})" + (held ? R"(, "pins": [{"indices": [0]}])" : "") + "}]}";
}

TEST(LinearChoice, ChangesAtAThousandUnknowns) {
  const std::vector<std::string> settings = {"/linear_solver/name=auto",
                                             R"(/formulation={"name": "log", "d_hat_m": 0.01})",
                                             "/time/dt_s=0.01", "/time/steps=1"};
  const RunConfig below = decided(sheet(25, true), settings), at = decided(sheet(25, false), settings);
  EXPECT_EQ(free_dofs(build_scene(below)), 998U);
  EXPECT_EQ(below.linear_solver.name, "lagged_cholesky");
  EXPECT_EQ(free_dofs(build_scene(at)), 1000U);
  EXPECT_EQ(at.linear_solver.name, "pcg");
}

TEST(LinearChoice, VerticesInThePlaneHaveTwoUnknowns) {
  const RunConfig config = decided(R"({"name": "drape2d"})", {"/linear_solver/name=auto"});
  const Scene scene = build_scene(config);
  ASSERT_TRUE(scene.planar);
  EXPECT_EQ(free_dofs(scene),
            2 * (static_cast<std::size_t>(scene.n_vertices()) - holding_pins(scene, 0).size()));
  ASSERT_LT(free_dofs(scene), 1000U);
  EXPECT_EQ(config.linear_solver.name, "lagged_cholesky");
}

TEST(LinearChoice, KeepsThePreconditionerThatIsAskedFor) {
  const RunConfig given =
      decided(hanging(19), {"/linear_solver/name=auto", "/linear_solver/preconditioner=ic0"});
  EXPECT_EQ(given.linear_solver.name, "pcg");
  EXPECT_EQ(text(given.linear_solver.parameters, "preconditioner"), "ic0");
  const RunConfig small =
      decided(hanging(18), {"/linear_solver/name=auto", "/linear_solver/preconditioner=ic0"});
  EXPECT_EQ(small.linear_solver.name, "lagged_cholesky");
  EXPECT_EQ(text(small.linear_solver.parameters, "preconditioner"), "ic0");
  EXPECT_EQ(preconditioner_of({"pcg", {}}), "block_jacobi");
  EXPECT_EQ(preconditioner_of({"pcg_resident", {}}), "block_jacobi");
  EXPECT_EQ(preconditioner_of({"cholmod", {}}), "none");
}

TEST(LinearChoice, LeavesAnyOtherSolver) {
  const RunConfig config = decided(hanging(19), {"/linear_solver/name=cholmod"});
  EXPECT_EQ(config.linear_solver.name, "cholmod");
  EXPECT_EQ(config.linear_solver_reason, "as requested");
}

}  // namespace
}  // namespace bb::linear_choice_test
