// What a config may not contain: keys, types, ranges, names, syntax; where it is reported, and all of it at once.
#include <set>

#include "tests/config/config_text.hpp"

namespace bb::test::parse_test {
namespace {

struct Wrong {
  std::string pointer;
  json value;
  std::string allowed;  // part of what the message allows
};

TEST(Parse, TheConfigsOfTheTestsAreAccepted) {
  EXPECT_EQ(parsed(hang_config()).scene.name, "hang");
  EXPECT_EQ(parsed(bodies_config()).scene.bodies.size(), 1u);
}

TEST(Parse, AFileOfAnotherFormatIsOneViolationWithItsVerb) {
  json sweep = with(hang_config(), "/schema", "barrierbench.sweep/1");
  sweep["axes"] = json::array();
  try {
    parsed(sweep);
    FAIL() << "a sweep was read as a config";
  } catch (const ConfigError& error) {
    ASSERT_EQ(error.violations().size(), 1u) << error.what();
    EXPECT_NE(error.violations()[0].where.find("#/schema"), std::string::npos);
    EXPECT_NE(error.violations()[0].allowed.find("./bench sweep FILE"), std::string::npos);
  }
}

TEST(Parse, UnknownKeysSuggestTheNearest) {
  const std::vector<std::pair<std::string, std::string>> keys = {
      {"/tim", "time"},
      {"/time/stepz", "steps"},
      {"/formulation/d_hatm", "d_hat_m"},
      {"/formulation/stiffness_policy/kapa_N_per_m", "kappa_N_per_m"},
      {"/step_solver/armjo", "armijo"},
      {"/contact/molifier", "mollifier"},
      {"/seeds/jiter_m", "jitter_m"}};
  for (const auto& [pointer, nearest] : keys) {
    const std::string key = pointer.substr(pointer.rfind('/') + 1);
    expect_violation(with(hang_config(), pointer, 1), pointer, "the unknown key \"" + key + '"',
                     "(did you mean " + nearest + "?)");
  }
  expect_violation(with(bodies_config(), "/scene/bodies/0/pin", 1), "/scene/bodies/0/pin",
                   "the unknown key \"pin\"", "(did you mean pins?)");
}

TEST(Parse, WrongTypesAndRangesAreNamedWithTheirUnit) {
  const std::vector<Wrong> cases = {
      {"/time/dt_s", 0, "a number >= 1e-18 and <= 1e+09 (s)"},
      {"/time/dt_s", "0.01", "a number >= 1e-18 and <= 1e+09 (s)"},
      {"/time/steps", 2.5, "an integer >= 1"},
      {"/time/steps", 0, "an integer >= 1"},
      {"/time", json::array(), "an object"},
      {"/formulation/d_hat_m", -0.01, "a number >= 1e-15 and <= 1e+15 (m)"},
      {"/formulation/stiffness_policy/kappa_N_per_m", 0, "a number >= 1e-36 and <= 1e+18 (N/m)"},
      {"/strain_limit/limit", 0, "a number >= 1e-36 and <= 10"},
      {"/threads", -1, "an integer >= 0"},
      {"/passes/audit", "yes", "true or false"},
      {"/diagnose/scalings/0", "jacoby", "(did you mean jacobi?)"},
      {"/contact/hessian_mode", "gauss", "one of gauss_newton, projected_full"},
      {"/schema", "barrierbench.config/2", "barrierbench.config/1"},
      {"/seeds/main", nullptr, "an integer >= 0"},
  };
  for (const Wrong& wrong : cases) {
    json config = hang_config();
    if (wrong.pointer == "/diagnose/scalings/0") config["diagnose"]["scalings"] = json::array({"none"});
    expect_violation(with(config, wrong.pointer, wrong.value), wrong.pointer, wrong.value.dump(),
                     wrong.allowed);
  }
}

TEST(Parse, UnknownNamesSuggestTheNearest) {
  const std::vector<Wrong> cases = {
      {"/scene/name", "hnag", "(did you mean hang?)"},
      {"/formulation/name", "cubicc", "(did you mean cubic?)"},
      {"/formulation/shape", "quadradic", "(did you mean quadratic?)"},
      {"/formulation/stiffness_policy/name", "fixd", "(did you mean fixed?)"},
      {"/strain_limit/shape", "lg", "(did you mean log?)"},
      {"/integrator/name", "bdf3", "(did you mean bdf2?)"},
      {"/step_solver/name", "line_serch", "(did you mean line_search?)"},
      {"/linear_solver/name", "cholmodd", "(did you mean cholmod?)"},
  };
  for (const Wrong& wrong : cases) {
    expect_violation(with(hang_config(), wrong.pointer, wrong.value), wrong.pointer, wrong.value.dump(),
                     wrong.allowed);
  }
  expect_violation(with(hang_config(), "/scene/widht_m", 1), "/scene/widht_m", "the unknown key \"widht_m\"",
                   "(did you mean width_m?)");
  expect_violation(with(bodies_config(), "/scene/bodies/0/mesh/generator", "gird"),
                   "/scene/bodies/0/mesh/generator", "\"gird\"", "(did you mean grid?)");
}

TEST(Parse, AllViolationsComeAtOnce) {
  json config = hang_config();
  config["tim"] = 1;
  config["formulation"] = {{"name", "log"}, {"shape", "quadradic"}, {"d_hat_m", "wide"}};
  config["time"] = {{"dt_s", -1}, {"steps", 0}};
  config["integrator"] = {{"name", "bdf3"}};

  std::set<std::string> places;
  for (const Violation& v : violations_of(config.dump(), {"nonsense"})) places.insert(v.where);

  EXPECT_EQ(places, (std::set<std::string>{"--set nonsense", "a.json#/tim", "a.json#/formulation/shape",
                                           "a.json#/formulation/d_hat_m", "a.json#/time/dt_s",
                                           "a.json#/time/steps", "a.json#/integrator/name"}));
}

TEST(Parse, WhatIsMissingIsNamed) {
  expect_violation({{"schema", "barrierbench.config/1"}}, "/scene", "nothing", "an object");
  json config = bodies_config();
  config.erase("time");
  config["formulation"] = "cubic";
  std::set<std::string> places;
  for (const Violation& v : violations_of(config.dump())) {
    EXPECT_EQ(v.found, "nothing");
    places.insert(v.where);
  }
  EXPECT_EQ(places, (std::set<std::string>{"a.json#/formulation/d_hat_m", "a.json#/time/dt_s",
                                           "a.json#/time/steps"}));
}

TEST(Parse, SyntaxErrorsHaveALine) {
  EXPECT_EQ(violations_of("{\n\"scene\": {,\n}").at(0).where, "a.json:2");
  EXPECT_EQ(violations_of("").at(0).where, "a.json:1");
  EXPECT_EQ(violations_of("{\"scene\": NaN}").at(0).where, "a.json:1");
  EXPECT_NE(violations_of("{\"time\": {}, \"time\": {}}").at(0).found.find("\"time\" twice"),
            std::string::npos);
  EXPECT_EQ(violations_of("[]").at(0).found, "[]");
}

TEST(Parse, OverridesAreSetInOrderAndJudgedLikeTheFile) {
  const RunConfig config = parsed(
      hang_config(), {"/time/steps=3", "/time/steps=4", "/formulation=cubic", "/formulation/d_hat_m=0.02"});
  EXPECT_EQ(config.time.steps, 4);
  EXPECT_EQ(config.formulation.shape, "cubic");
  EXPECT_EQ(config.formulation.d_hat, 0.02);
  for (const char* wrong : {"nonsense", "time/steps=3", "/time/steps"}) {
    const std::vector<Violation> violations = violations_of(hang_config().dump(), {wrong});
    ASSERT_EQ(violations.size(), 1u) << wrong;
    EXPECT_EQ(violations[0].where, std::string("--set ") + wrong);
  }
  EXPECT_EQ(violations_of(hang_config().dump(), {"/time/dt_s=1e400"}).at(0).where, "--set /time/dt_s=1e400");
}

TEST(Parse, OverridesMakeKeysButNeverElements) {
  EXPECT_EQ(parsed(hang_config(), {"/seeds/main=3"}).seeds.main, 3u);
  EXPECT_EQ(parsed(bodies_config(), {"/scene/bodies/0/offset_m=0.5"}).scene.bodies[0].spec.offset, 0.5);
  EXPECT_EQ(violations_of(hang_config().dump(), {"/seeds/300000000=1"}).at(0).where,
            "a.json#/seeds/300000000");
  for (const char* wrong :
       {"/scene/bodies/1/offset_m=1", "/scene/bodies/300000000=1", "/scene/bodies/-=1",
        "/scene/bodies/-1/name=a", "/scene/bodies/18446744073709551616=1", "/time/dt_s/x=1"}) {
    const std::vector<Violation> violations = violations_of(bodies_config().dump(), {wrong});
    ASSERT_EQ(violations.size(), 1u) << wrong;
    EXPECT_EQ(violations[0].where, std::string("--set ") + wrong);
  }
}

TEST(Parse, ValuesOfOverridesAreJsonOrBareWords) {
  EXPECT_EQ(parsed(hang_config(), {"/formulation=cubic"}).formulation.shape, "cubic");
  EXPECT_EQ(parsed(hang_config(), {"/formulation=\"cubic\""}).formulation.shape, "cubic");
  for (const char* wrong : {"/time={\"dt_s\": 1", "/time={\"dt_s\": 1, \"dt_s\": 2}",
                            "/seeds/main=9007199254740993", "/formulation=\xff", "/formulation=\"cubic"}) {
    const std::vector<Violation> violations = violations_of(hang_config().dump(), {wrong});
    ASSERT_EQ(violations.size(), 1u) << wrong;
    EXPECT_EQ(violations[0].where, std::string("--set ") + wrong);
  }
}

TEST(Parse, ANameBecomesAFolderAndHasToBePlain) {
  for (const char* wrong : {"../../up", "a/b", "..", ""}) {
    json config = hang_config();
    config["formulation"] = {
        {"name", wrong}, {"shape", "log"}, {"argument", "gap"}, {"stiffness_policy", {{"name", "fixed"}}}};
    const std::vector<Violation> violations = violations_of(config.dump());
    ASSERT_EQ(violations.size(), 1u) << wrong;
    EXPECT_EQ(violations[0].where, "a.json#/formulation/name");
    EXPECT_NE(violations[0].allowed.find("folders are named after it"), std::string::npos);
  }
}

TEST(Parse, APresetWithAnotherShapeLosesItsName) {
  EXPECT_EQ(parsed(hang_config(), {"/formulation=\"log\""}).formulation.name, "log");
  EXPECT_EQ(parsed(hang_config(), {"/formulation=\"log\"", "/formulation/d_hat_m=0.02"}).formulation.name,
            "log");
  for (const char* other : {"/formulation/shape=\"cubic\"", "/formulation/argument=\"squared_gap\"",
                            "/formulation/stiffness_policy={\"name\": \"elasticity_inclusive\"}"}) {
    EXPECT_EQ(parsed(hang_config(), {"/formulation=\"log\"", other}).formulation.name, "") << other;
  }
  const RunConfig whole =
      parsed(hang_config(), {"/formulation={\"name\": \"log\", \"shape\": \"cubic\", "
                             "\"argument\": \"gap\", \"stiffness_policy\": {\"name\": \"fixed\"}}"});
  EXPECT_EQ(whole.formulation.name, "");
}

TEST(Parse, MissingMeshFilesAreNamed) {
  const json config = with(bodies_config(), "/scene/bodies/0/mesh", {{"file", "nowhere.ply"}});
  const std::vector<Violation> violations = violations_of(config.dump());
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].where, "a.json#/scene/bodies/0/mesh/file");
  EXPECT_NE(violations[0].found.find("/nowhere.ply"), std::string::npos);
  EXPECT_THROW(load_config("nowhere.json"), ConfigError);
}

}  // namespace
}  // namespace bb::test::parse_test
