// A whole run on the smallest scene: what makes its record valid, and what ends it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/base/record/writer.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/runner.hpp"
#include "tests/energy/kappa_of_element.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::run_config_test {
namespace {

constexpr const char* block = R"({"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"},
  "formulation": {"name": "cubic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force", "load_N": 1},
  "time": {"steps": 3}})";

RunRecord run(const std::vector<std::string>& overrides) {
  RunOptions options;
  options.build.valid = true;
  options.build.checks = 1;
  const test::TemporaryFolder folder;
  options.folder = folder;
  RunRecord record = run_config(parse_config(block, "test", ".", overrides), options);
  const std::filesystem::path file = options.folder / "run.json";
  const auto read = read_run(file);
  EXPECT_TRUE(read.has_value());
  if (read) {
    std::ifstream in(file);
    EXPECT_EQ(to_json(*read), std::string(std::istreambuf_iterator<char>(in), {}));
  }
  return record;
}

const Check* check(const RunRecord& record, const std::string& name) {
  const auto& all = record.validity.checks;
  const auto found = std::find_if(all.begin(), all.end(), [&](const Check& c) { return c.name == name; });
  return found == all.end() ? nullptr : &*found;
}

TEST(RunConfig, a_run_is_valid_when_every_check_passed) {
  const RunRecord record = run({"/passes/time=true", "/passes/audit=true"});
  EXPECT_EQ(record.status.outcome, Outcome::ok);
  EXPECT_TRUE(record.validity.valid);
  EXPECT_TRUE(record.status.valid);
  for (const char* name : {"audit_clean", "audit_judged", "state_hash_equal_in_all_passes", "outcome_ok"}) {
    ASSERT_NE(check(record, name), nullptr) << name;
    EXPECT_TRUE(check(record, name)->pass) << name;
  }
  EXPECT_EQ(check(record, "strain_limit_kept"), nullptr);  // there is no limit
  EXPECT_GT(check(record, "audit_judged")->value.value, 0);
  EXPECT_EQ(record.summary.steps, 3);
  EXPECT_GT(record.summary.wall_s.value, 0);
  EXPECT_EQ(record.labels.d_hat_m, 0.01);
}

TEST(RunConfig, a_planar_vertex_has_two_degrees_of_freedom) {
  const RunRecord pinned =
      run({R"(/scene={"name": "drape2d", "variant": "pinned", "n": 4})", "/time/steps=1"});
  EXPECT_EQ(pinned.scene.vertices, 16U);
  EXPECT_EQ(pinned.scene.free_dofs, 2 * 12U);  // the top row is pinned
}

TEST(RunConfig, a_run_ends_at_its_first_step_that_failed_and_is_not_valid) {
  const RunRecord record = run({"/step_solver/max_iterations=1"});
  EXPECT_EQ(record.status.outcome, Outcome::newton_stall);
  EXPECT_EQ(record.summary.steps, 1);
  EXPECT_EQ(record.summary.steps_capped, 1);
  EXPECT_FALSE(record.validity.valid);
  EXPECT_FALSE(record.status.valid);
  EXPECT_FALSE(check(record, "outcome_ok")->pass);
  EXPECT_TRUE(check(record, "audit_clean")->pass);
}

TEST(RunConfig, the_method_has_every_number_of_its_config) {
  const std::vector<std::string> overrides = {
      "/contact/min_gap_fraction=3e-5", "/step_solver/armijo=0.02",
      "/step_solver/cap_fraction=0.7",  "/step_solver/max_iterations=17",
      "/integrator/name=bdf2",          "/step_solver/tol_velocity_m_per_s=0.003"};
  const RunConfig config = parse_config(block, "test", ".", overrides);
  Calibration calibration;
  calibration.kappa = 5;
  const Method method = make_method(config, calibration);
  EXPECT_EQ(method.contact_options.min_gap_fraction, 3e-5);
  EXPECT_EQ(number(method.step_solver.parameters, "armijo"), 0.02);
  EXPECT_EQ(number(method.step_solver.parameters, "cap_fraction"), 0.7);
  EXPECT_EQ(method.step_solver.max_iterations, 17);
  EXPECT_EQ(method.step_solver.tol_velocity, 0.003);
  EXPECT_EQ(method.integrator->name(), "bdf2");
  EXPECT_FALSE(method.contact.literal);
  EXPECT_FALSE(method.limit.literal);
}

TEST(RunConfig, factors_of_a_limit_multiply_what_it_is_given) {
  PolicyConfig fixed;
  fixed.name = "fixed";
  fixed.parameters["k_s_N_per_m"] = 4.0;
  fixed.scale = 3;
  Calibration calibration;
  calibration.limited = true;
  EXPECT_EQ(test::kappa_of_element(*make_limit_policy(fixed, calibration)), 2 * 12);
  calibration.k_s = 5;
  EXPECT_EQ(test::kappa_of_element(*make_limit_policy(fixed, calibration)), 2 * 15);

  PolicyConfig dynamic;
  dynamic.name = "elasticity_inclusive";
  dynamic.parameters = {{"mass_term", "paper"},
                        {"elastic_term", true},
                        {"refresh", "per_step"},
                        {"gap_floor", 0.0},
                        {"derivative", "included"}};
  dynamic.scale = 3;
  calibration.limit_scale = 7;
  EXPECT_EQ(test::kappa_of_element(*make_limit_policy(dynamic, calibration)), 21 * 1 / 0.25);
  EXPECT_TRUE(make_limit_policy(dynamic, calibration)->has_potential());
}

}  // namespace
}  // namespace bb::run_config_test
