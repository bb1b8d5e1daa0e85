// Settings that are right one by one and wrong together.
#include "tests/config/config_text.hpp"

namespace bb::test::contradictions_test {
namespace {

TEST(Contradictions, StepSolverAndIntegrator) {
  json config = with(hang_config(), "/integrator/name", "bdf2");
  EXPECT_EQ(parsed(config).integrator.name, "bdf2");
  config["step_solver"]["name"] = "accumulated_toi";
  expect_violation(config, "/integrator/name", "\"bdf2\"", "implicit_euler");
  expect_violation(with(hang_config(), "/step_solver/name", "article_literal"), "/step_solver/name",
                   "\"article_literal\"", "protocol article_literal");
}

TEST(Contradictions, ContactThatStopsWithinAStepAndFormulasOfSecondOrder) {
  for (const char* solver : {"augmented_lagrangian", "al_free"}) {
    for (const char* integrator : {"newmark", "bdf2"}) {
      json config = with(hang_config(), "/step_solver/name", solver);
      EXPECT_EQ(parsed(config).step_solver.name, solver);
      config["integrator"]["name"] = integrator;
      expect_violation(config, "/integrator/name", '"' + std::string(integrator) + '"',
                       "implicit_euler, half_gravity, quasi_static: the step solver " + std::string(solver));
    }
  }
}

TEST(Contradictions, OnlyASolverThatTestsEnergiesLeavesASaddle) {
  json config = hang_config();
  EXPECT_EQ(parsed(config).step_solver.saddle, SaddleRule::escape);
  EXPECT_EQ(parsed(with(config, "/step_solver/saddle", "ignore")).step_solver.saddle, SaddleRule::ignore);
  config["step_solver"]["name"] = "accumulated_toi";
  EXPECT_EQ(parsed(config).step_solver.saddle, SaddleRule::ignore);
  EXPECT_EQ(parsed(with(config, "/step_solver/saddle", "report")).step_solver.saddle, SaddleRule::report);
  expect_violation(with(config, "/step_solver/saddle", "escape"), "/step_solver/saddle", "\"escape\"",
                   "report or ignore");
}

TEST(Contradictions, AToleranceAtWhichNothingFalls) {
  expect_violation(with(hang_config(), "/step_solver/tol_velocity_m_per_s", 1),
                   "/step_solver/tol_velocity_m_per_s", "1", "0.1 min(d_hat, |g| dt^2/2)/dt");
}

TEST(Contradictions, ASettingThatThePolicyDoesNotRead) {
  const std::string policy = "/formulation/stiffness_policy";
  expect_violation(with(hang_config(), policy, {{"name", "ipc_adaptive"}, {"kappa_N_per_m", 5}}),
                   policy + "/kappa_N_per_m", "5", "ipc_adaptive does not read it");
  expect_violation(
      with(hang_config(), policy, {{"name", "fixed"}, {"kappa_N_per_m", 5}, {"mass_term", "none"}}),
      policy + "/mass_term", "\"none\"", "fixed does not read it");
}

TEST(Contradictions, BoundsOfAnAdaptiveKappa) {
  const std::string policy = "/formulation/stiffness_policy";
  expect_violation(with(hang_config(), policy,
                        {{"name", "ipc_adaptive"}, {"kappa_min_N_per_m", 5}, {"kappa_max_N_per_m", 4}}),
                   policy + "/kappa_min_N_per_m", "5", "at most kappa_max_N_per_m = 4");
  expect_violation(with(hang_config(), policy, {{"name", "elasticity_inclusive"}, {"doubling_gap_m", 1e-9}}),
                   policy + "/doubling_gap_m", "1e-09", "elasticity_inclusive does not read it");
}

TEST(Contradictions, APolicyThatCouldNotStart) {
  const std::string policy = "/formulation/stiffness_policy";
  expect_violation(with(hang_config(), policy,
                        {{"name", "elasticity_inclusive"}, {"mass_term", "none"}, {"elastic_term", false}}),
                   policy, "mass_term none with elastic_term false", "else kappa is 0");

  json slow = with(hang_config(), "/formulation", "ipc2020");
  slow["integrator"] = {{"name", "quasi_static"}};
  expect_violation(slow, policy + "/name", "\"ipc_adaptive\"", "it starts from inertia");
  json concave = with(hang_config(), policy, {{"name", "ipc_adaptive"}});
  concave["formulation"]["shape"] = "quadratic";
  concave["formulation"]["argument"] = "squared_gap";
  expect_violation(concave, policy + "/name", "\"ipc_adaptive\"", "quadratic on squared_gap is not > 0");
  for (json config : {with(slow, "/formulation", {{"name", "ipc2020"}}), concave}) {
    config["formulation"]["stiffness_policy"] = {
        {"name", "ipc_adaptive"}, {"kappa_min_N_per_m", 4}, {"kappa_max_N_per_m", 5}};
    EXPECT_EQ(number(parsed(config).formulation.stiffness_policy.parameters, "kappa_max_N_per_m"), 5);
  }
}

TEST(Contradictions, AStiffnessThatHasNoPotential) {
  const std::string policy = "/formulation/stiffness_policy";
  json config = hang_config();
  config["formulation"] = {{"name", "cubic_dynamic_consistent"}};
  EXPECT_EQ(text(parsed(config).formulation.stiffness_policy.parameters, "derivative"), "included");
  // the limit follows the contacts
  const RunConfig limited = parsed(with(config, "/strain_limit", {{"limit", 0.1}}));
  EXPECT_EQ(text(limited.strain_limit.stiffness_policy.parameters, "derivative"), "included");

  json log = with(config, "/strain_limit", {{"shape", "cubic"}, {"limit", 0.1}});
  log["formulation"]["shape"] = "log";
  expect_violation(log, policy + "/derivative", "\"included\" with log on gap",
                   "argument gap and one of the shapes with a potential: quadratic, cubic");
  json squared = with(config, "/strain_limit", {{"argument", "gap"}, {"limit", 0.1}});
  squared["formulation"]["argument"] = "squared_gap";
  expect_violation(squared, policy + "/derivative", "\"included\" with cubic on squared_gap", "argument gap");
  json often = with(config, "/strain_limit/stiffness_policy", {{"refresh", "per_step"}});
  often["strain_limit"]["limit"] = 0.1;
  often["formulation"]["stiffness_policy"] = {{"refresh", "per_iteration"}};
  expect_violation(often, policy + "/refresh", "\"per_iteration\"", "per_step, or derivative dropped");

  json floor = config;
  floor["formulation"]["stiffness_policy"] = {{"gap_floor", 0.1}};
  floor["strain_limit"] = {{"stiffness_policy", {{"gap_floor", 0}}}};
  expect_violation(floor, policy + "/gap_floor", "0.1", "0, or derivative dropped");

  const std::string limit = "/strain_limit/stiffness_policy";
  json two_stage = with(config, "/strain_limit", {{"shape", "two_stage"}, {"limit", 0.1}});
  expect_violation(two_stage, limit + "/derivative", "\"included\" with two_stage on gap", "cubic");
  two_stage["strain_limit"]["stiffness_policy"] = {{"derivative", "dropped"}};
  EXPECT_EQ(parsed(two_stage).strain_limit.shape, "two_stage");
  json own = with(config, "/strain_limit", {{"limit", 0.1}});
  own["strain_limit"]["stiffness_policy"] = {{"refresh", "per_iteration"}};
  expect_violation(own, limit + "/refresh", "\"per_iteration\"", "per_step");
  own["strain_limit"]["stiffness_policy"] = {{"mass_term", "inertia"}};
  expect_violation(own, limit + "/derivative", "\"included\" with mass_term inertia", "paper or scaled");
}

TEST(Contradictions, MatchingWithoutWhatItAsksFor) {
  json config = with(hang_config(), "/formulation/argument", "squared_gap");
  config["formulation"]["shape"] = "quadratic";
  config["strain_limit"] = {{"shape", "log"}, {"argument", "gap"}};
  config["matching"] = {{"rule", "equal_curvature"}};
  expect_violation(config, "/matching/rule", "\"equal_curvature\"", "quadratic on squared_gap is not > 0");
  config["matching"] = {{"rule", "equal_force"}};
  EXPECT_EQ(parsed(config).matching.rule, MatchingRule::equal_force);
  config["matching"]["limit_load_N_per_m"] = 1e308;
  expect_violation(config, "/matching/limit_load_N_per_m", "1e+308", "a number >= 1e-36 and <= 1e+18 (N/m)");
}

TEST(Contradictions, ACalibrationRunWithoutWeight) {
  json config = with(bodies_config(), "/scene/gravity_m_per_s2", {0, 0, 0});
  config["matching"] = {{"rule", "equal_force"}};
  expect_violation(config, "/matching/load_N", "nothing", "without gravity no calibration run can start");
  config["matching"]["load_N"] = 1;
  EXPECT_EQ(parsed(config).matching.load, 1);
  config["formulation"]["name"] = "cubic_dynamic";
  expect_violation(config, "/matching/rule", "\"equal_force\"", "as_given: policy elasticity_inclusive");
}

TEST(Contradictions, ALimitOnNothingNeedsNoCalibrationRun) {
  json config = with(bodies_config(), "/scene/gravity_m_per_s2", {0, 0, 0});
  config["matching"] = {{"rule", "equal_force"}, {"load_N", 1}};
  config["strain_limit"] = {{"limit", 0.1}};
  expect_violation(config, "/matching/limit_load_N_per_m", "nothing",
                   "without gravity no calibration run can start");
  config["scene"]["bodies"][0]["limited"] = false;
  EXPECT_TRUE(parsed(config).strain_limit.enabled);
}

TEST(Contradictions, AConventionOfKappaOfAnotherFormulation) {
  const std::string policy = "/formulation/stiffness_policy";
  expect_violation(with(hang_config(), policy, {{"name", "fixed"}, {"kappa_a_J", 5}}), policy + "/kappa_a_J",
                   "5", "shape cubic");
  expect_violation(
      with(hang_config(), policy, {{"name", "fixed"}, {"kappa_N_per_m", 5}, {"kappa_ipc_N_per_m3", 5}}),
      policy + "/kappa_ipc_N_per_m3", "5", "kappa_N_per_m is given too");
}

TEST(Contradictions, LimitGivenTwice) {
  expect_violation(with(hang_config(), "/strain_limit", {{"limit", 0.1}, {"onset", 0.1}, {"width", 0.1}}),
                   "/strain_limit/limit", "0.1", "either limit, or onset and width");
}

TEST(Contradictions, DiagnosesWithoutTheirSource) {
  json config = hang_config();
  config["passes"] = {{"diagnose", true}};
  config["diagnose"] = {{"estimator", "ritz"}};
  expect_violation(config, "/diagnose/estimator", "ritz", "pcg");
  config["linear_solver"] = {{"name", "pcg"}};
  expect_violation(config, "/diagnose/estimator", "ritz", "linear_solver.forcing fixed");
  config["linear_solver"]["forcing"] = "fixed";
  EXPECT_EQ(parsed(config).diagnose.estimator, Estimator::ritz);
  config["diagnose"]["scalings"] = {"none"};
  expect_violation(config, "/diagnose/estimator", "ritz", "a preconditioner among diagnose.scalings");
  config["linear_solver"]["preconditioner"] = "none";
  EXPECT_EQ(parsed(config).diagnose.estimator, Estimator::ritz);
  config["diagnose"]["stages"] = {"without_contact"};
  expect_violation(config, "/diagnose/stages", "no stage full", "the matrix that PCG solves");
}

TEST(Contradictions, ALimitThatFollowsTheContactPolicyFollowsAllOfIt) {
  json config = hang_config();
  config["strain_limit"] = {{"limit", 0.1}};
  config["formulation"] = {{"shape", "cubic"},
                           {"stiffness_policy", {{"name", "elasticity_inclusive"}, {"elastic_term", false}}}};
  EXPECT_FALSE(boolean(parsed(config).strain_limit.stiffness_policy.parameters, "elastic_term"));
  config["strain_limit"]["stiffness_policy"] = {{"elastic_term", true}};
  EXPECT_TRUE(boolean(parsed(config).strain_limit.stiffness_policy.parameters, "elastic_term"));
  EXPECT_FALSE(boolean(parsed(config).formulation.stiffness_policy.parameters, "elastic_term"));
}

TEST(Contradictions, BodiesOfOneKindWithKeysOfAnother) {
  expect_violation(with(bodies_config(), "/scene/bodies/0/motion", {{"velocity_m_per_s", {0, 0, 1}}}),
                   "/scene/bodies/0/motion", "motion of a deformable body", "kind rigid");
  json rigid = with(bodies_config(), "/scene/bodies/0/kind", "rigid");
  expect_violation(rigid, "/scene/bodies/0/pins", "pins of a rigid body", "every vertex");
  const json plane = {{"name", "floor"}, {"kind", "plane"}, {"radius_m", 1}};
  expect_violation(with(bodies_config(), "/scene/obstacles", json::array({plane})),
                   "/scene/obstacles/0/radius_m", "radius_m of a plane", "another kind of obstacle");
  json twice = bodies_config();
  twice["scene"]["bodies"].push_back(twice["scene"]["bodies"][0]);
  expect_violation(twice, "/scene/bodies/1/name", "\"cloth\"", "no other body");
}

}  // namespace
}  // namespace bb::test::contradictions_test
