// Every word that a run, a step or a linear solve may end with, reached by a run or by a small simulation, with what
// its message has to name. A word without a case makes the last test red.
#include <gtest/gtest.h>

#include <functional>

#include "core/base/record/step_status.hpp"
#include "core/base/record/trace_row.hpp"
#include "tests/experiments/endings.hpp"

namespace bb::test::every_outcome_test {
namespace {

std::string grids(const std::string& more) {
  return R"({"schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": 0.01},
    "passes": {"time": false, "audit": true}, "time": {"dt_s": 0.01, "steps": 2}, "scene": {"bodies": [
      {"name": "cloth", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}},
      {"name": "other", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "transform": )" +
         more + R"(}, {"name": "free", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2},
        "transform": {"translate_m": [0, 0, 5]}}]}})";
}

const char* hanging =
    R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "pinned", "n": 6},
  "formulation": "log", "passes": {"time": false, "audit": true}, "time": {"steps": 2},
  "linear_solver": {"name": "pcg", "forcing": "fixed"}})";

struct Case {
  const char* name;
  Outcome outcome;
  const char *step, *solve;  // words among those of its steps and solves; null: not checked
  std::vector<std::string> says;
  std::function<Ending()> reach;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"a block that comes to rest", Outcome::ok, "converged", "ok", {}, [] { return run(resting_block); }},
      {"an element that begins beyond its strain limit",
       Outcome::invalid_scene,
       nullptr,
       nullptr,
       {"stretched by 0.25", "cloth"},
       [] {
         return run(
             grids(R"({"translate_m": [0, 0, 0.05]})"),
             {R"(/scene/bodies/0/rest_mesh={"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.8, "size_y_m": 0.8})",
              "/strain_limit/limit=0.1"});
       }},
      {"prescribed bodies that cross",
       Outcome::given_parts_cross,
       nullptr,
       nullptr,
       {"cloth[", "other["},
       [] {
         return run(grids(R"({"axis": [1, 0, 0], "angle_deg": 90, "translate_m": [0.1, 0.1, 0.05]})"),
                    {R"(/scene/bodies/0/kind="rigid")", R"(/scene/bodies/1/kind="rigid")"});
       }},
      {"bodies that cross at the start",
       Outcome::initial_intersection,
       nullptr,
       nullptr,
       {"cloth[", "other["},
       [] { return run(grids(R"({"axis": [1, 0, 0], "angle_deg": 90, "translate_m": [0.1, 0.1, 0.05]})")); }},
      {"pairs of vertices alone",
       Outcome::penetration,
       "converged",
       "ok",
       {"the first in step", "triangle sheet", "enters obstacle disk", "has no edge pairs"},
       [] {
         return run(R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "stack",
           "pairs": "vertex_vertex"}, "formulation": "quadratic", "matching": {"rule": "equal_force"},
           "passes": {"time": false, "audit": true}, "time": {"dt_s": 0.01, "steps": 4}})");
       }},
      {"a stiffness that overflows",
       Outcome::nan,
       "non_finite",
       "non_finite",
       {"step 0", "term contact", "particle[0]"},
       stiffness_that_overflows},
      {"a pin beyond the strain limit",
       Outcome::pin_infeasible,
       "pin_infeasible",
       "ok",
       {"step ", "vertex", "'cloth'"},
       torn_cloth},
      {"no probe of a pair",
       Outcome::ccd_cap,
       "step_collapse",
       "ok",
       {"probe cap", "held by", "upper["},
       few_probes},
      {"a weight over the capacity",
       Outcome::stall_overload,
       nullptr,
       "ok",
       {"load over capacity", "obstacle: ", "block["},
       [] {
         return run(resting_block, {R"(/formulation/stiffness_policy={"name": "fixed", "kappa_N_per_m": 1})",
                                    R"(/matching={"rule": "as_given"})", "/time/steps=100"});
       }},
      {"one iteration",
       Outcome::newton_stall,
       "iteration_cap",
       "ok",
       {"step 0", "iteration_cap", "|dx|"},
       [] { return run(resting_block, {"/step_solver/max_iterations=1"}); }},
      {"a force without a potential",
       Outcome::newton_stall,
       "line_search_failed",
       "ok",
       {"line_search_failed"},
       shape_without_a_potential},
      {"a slope that underflows",
       Outcome::newton_stall,
       "not_descent",
       "ok",
       {"not_descent", "g . dx"},
       slope_that_underflows},
      {"one iteration of PCG",
       Outcome::linear_failure,
       "linear_failed",
       "iteration_cap",
       {"iteration_cap", "residual", "1 iterations"},
       [] {
         return run(hanging, {"/linear_solver/max_iterations=1", "/linear_solver/tol_rel=1e-12"});
       }},
      {"a tolerance of 1e-18",
       Outcome::linear_failure,
       "linear_failed",
       "tolerance_below_rounding",
       {"tolerance_below_rounding", "residual"},
       [] { return run(hanging, {"/linear_solver/tol_rel=1e-18"}); }},
      {"a diagonal of zeros",
       Outcome::linear_failure,
       "linear_failed",
       "preconditioner_indefinite",
       {"preconditioner_indefinite", "vertex 0"},
       [] {
         return floating_particle({"pcg", {{"preconditioner", "jacobi"}}});
       }},
      {"a particle that nothing holds",
       Outcome::not_pd,
       "linear_failed",
       "matrix_indefinite",
       {"matrix_indefinite", "vertex 0"},
       [] { return floating_particle({}); }},
      {"memory that runs out", Outcome::oom, "converged", "ok", {"step 2", "memory"}, greedy},
      {"a kernel that fails", Outcome::kernel_failed, nullptr, nullptr, {"step 0", "MultiplyDot"}, failing},
      {"a factor that is too large",
       Outcome::linear_failure,
       "linear_failed",
       "factor_too_large",
       {"step 0", "factor_too_large", "32-bit"},
       factor_too_large},
      {"no time",
       Outcome::timeout,
       nullptr,
       nullptr,
       {"time limit", "start check", "there was no first step"},
       [] { return run(resting_block, {}, 1e-9); }},
      {"motions that were not judged",
       Outcome::unproven,
       nullptr,
       nullptr,
       {"no judged motion", "in step 0"},
       unjudged},
  };
  return all;
}

template <class E>
std::set<std::string> words() {
  std::set<std::string> out;
  for (int i = 0; i < n_words<E>; ++i) out.emplace(to_string(static_cast<E>(i)));
  return out;
}

TEST(EveryOutcome, is_reached_and_named) {
  std::set<std::string> outcomes, steps, solves;
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    Ending end;
    EXPECT_NO_THROW(end = one.reach());
    EXPECT_EQ(end.outcome, one.outcome) << one.name << ": " << to_string(end.outcome) << ", " << end.detail;
    EXPECT_TRUE(!one.step || end.steps.contains(one.step)) << one.name << ": " << end.detail;
    EXPECT_TRUE(!one.solve || end.solves.contains(one.solve)) << one.name << ": " << end.detail;
    for (const std::string& part : one.says) {
      EXPECT_NE(end.detail.find(part), std::string::npos)
          << one.name << ": '" << part << "' in " << end.detail;
    }
    EXPECT_EQ(end.detail.empty(), one.outcome == Outcome::ok) << one.name;
    outcomes.emplace(to_string(one.outcome));
    if (one.step) steps.insert(one.step);
    if (one.solve) solves.insert(one.solve);
  }
  EXPECT_EQ(outcomes, words<Outcome>());
  EXPECT_EQ(steps, words<StepStatus>());
  EXPECT_EQ(solves, words<LinearStatus>());
}

TEST(EveryOutcome, contacts_are_there_where_they_decide) {
  int asked = 0;
  for (const Case& one : cases()) {
    if (one.outcome != Outcome::ok && one.outcome != Outcome::stall_overload) continue;
    EXPECT_GT(one.reach().contacts, 0) << one.name;
    ++asked;
  }
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace bb::test::every_outcome_test
