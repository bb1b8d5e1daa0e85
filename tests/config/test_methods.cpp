// Published methods: laid underneath what stands beside their name, over what is extended, and named for what they are when
// some of them is overridden; and the simulated time, which runs with different dt are compared at.
#include "experiments/config/methods.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "experiments/config/config_family.hpp"
#include "tests/config/config_text.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::test::methods_test {
namespace {

namespace fs = std::filesystem;

json asked_for(const std::string& method) { return with(hang_config(), "/method", method); }

/// Without the formulation that hang_config() gives.
json pure(const std::string& method) {
  json config = asked_for(method);
  config.erase("formulation");
  return config;
}

json pure_with(const std::string& method, const std::string& pointer, const json& value) {
  json config = pure(method);
  config[json::json_pointer(pointer)] = value;
  return config;
}

std::vector<std::string> overridden_in(const json& config, const std::vector<std::string>& overrides = {}) {
  return method_use(parsed(config, overrides)).overridden;
}

TEST(Methods, EveryOneIsWholeAndOverriddenByNothing) {
  const std::vector<std::string> names = method_names();
  ASSERT_GE(names.size(), 2u);
  for (const std::string& name : names) {
    const RunConfig config = parsed(pure(name));
    const MethodUse use = method_use(config);
    EXPECT_EQ(use.overridden, std::vector<std::string>()) << name;
    EXPECT_EQ(use.title(), name);
    EXPECT_FALSE(use.method.differs.empty()) << name;
    EXPECT_EQ(config_id(parse_config(resolved_json(config), "resolved")), config_id(config)) << name;
  }
}

TEST(Methods, TheCubicPapersIsWhatItsAuthorsRun) {
  const RunConfig config = parsed(pure("ando2024"));
  EXPECT_EQ(config.formulation.name, "cubic_dynamic");
  EXPECT_EQ(config.step_solver.name, "accumulated_toi");
  EXPECT_EQ(number(config.step_solver.parameters, "target_toi"), 0.25);
  EXPECT_EQ(config.linear_solver.name, "pcg");
  EXPECT_EQ(number(config.linear_solver.parameters, "tol_rel"), 1e-3);
  EXPECT_EQ(config.precision, Precision::single);
  EXPECT_EQ(config.time.dt, 1e-3);
  EXPECT_EQ(config.strain_limit.shape, "cubic");
  EXPECT_EQ(text(config.strain_limit.stiffness_policy.parameters, "refresh"), "per_iteration");
}

TEST(Methods, WhatStandsBesideTheNameWins) {
  const std::vector<std::string> formulation = overridden_in(asked_for("ando2024"));
  EXPECT_EQ(formulation.front(), "/formulation/name");  // hang_config() requests log
  EXPECT_EQ(method_use(parsed(asked_for("ando2024"))).title(), "ando2024, changed");
  const json config = pure_with("ando2024", "/precision", "double");
  EXPECT_EQ(parsed(config).precision, Precision::full);
  EXPECT_EQ(overridden_in(config), std::vector<std::string>{"/precision"});
  EXPECT_TRUE(overridden_in(pure_with("ando2024", "/precision", "float")).empty());
  EXPECT_TRUE(overridden_in(pure_with("ando2024", "/formulation/d_hat_m", 0.02)).empty());
  EXPECT_EQ(parsed(pure_with("ando2024", "/formulation/d_hat_m", 0.02)).formulation.d_hat, 0.02);
  EXPECT_EQ(overridden_in(pure_with("ando2024", "/formulation/stiffness_policy/scale", 2)),
            std::vector<std::string>{"/formulation/stiffness_policy/scale"});
  EXPECT_TRUE(overridden_in(pure_with("ando2024", "/strain_limit/enabled", false)).empty());
}

/// The record of a run has its resolved config, which has the name of the method too.
void expect_repeats(const RunConfig& config) {
  EXPECT_EQ(config_id(parse_config(resolved_json(config), "resolved")), config_id(config));
  EXPECT_EQ(method_use(config).title(), "ando2024, changed");
}

TEST(Methods, APolicyOfAnotherNameTakesNothingFromTheirs) {
  const json fixed = {{"name", "fixed"}, {"kappa_N_per_m", 100}},
             limit = {{"name", "fixed"}, {"k_s_N_per_m", 3}};
  const RunConfig beside = parsed(pure_with("ando2024", "/formulation/stiffness_policy", fixed));
  EXPECT_EQ(beside.formulation.stiffness_policy.name, "fixed");
  EXPECT_EQ(beside.formulation.name, "");
  expect_repeats(beside);
  expect_repeats(parsed(pure_with("ando2024", "/strain_limit/stiffness_policy", limit)));
  json plain = hang_config();
  plain.erase("formulation");
  const RunConfig set = parsed(plain, {"/method=ando2024", "/formulation/stiffness_policy/name=fixed",
                                       "/formulation/stiffness_policy/kappa_N_per_m=100"});
  EXPECT_EQ(set.formulation.stiffness_policy.parameters, beside.formulation.stiffness_policy.parameters);
  expect_repeats(set);
  expect_repeats(parsed(plain, {"/method=ando2024", "/formulation/stiffness_policy=" + fixed.dump()}));
}

TEST(Methods, FrictionIsThatOfThePublicationWhereACoefficientIsAboveZero) {
  const json rubs = pure_with("ando2024", "/friction/mu", 0.3);
  const RunConfig config = parsed(rubs);
  EXPECT_EQ(config.friction.law, "capped");
  EXPECT_EQ(config.friction.refresh, FrictionRefresh::per_iteration);
  EXPECT_EQ(config.friction.hessian, FrictionHessian::secant);
  EXPECT_EQ(config.friction.eps_m, 1e-5);
  EXPECT_EQ(config.friction.combine, CombineRule::max);
  EXPECT_EQ(config.friction.mu, 0.3);
  EXPECT_EQ(method_use(config).title(), "ando2024");
  EXPECT_EQ(config_id(parse_config(resolved_json(config), "resolved")), config_id(config));
  EXPECT_EQ(overridden_in(rubs, {"/friction/eps_m=1e-4"}), std::vector<std::string>{"/friction/eps_m"});
  EXPECT_EQ(parsed(rubs, {"/friction/law=smoothed_coulomb"}).friction.law, "smoothed_coulomb");

  json form = hang_config();  // of a file that a method is laid over
  form.erase("formulation");
  form["friction"] = {{"mu", 0.2}, {"law", "smoothed_coulomb"}, {"combine", "mean"}};
  const RunConfig over = parsed(form, {"/method=ando2024"});
  EXPECT_EQ(over.friction.law, "capped");
  EXPECT_EQ(over.friction.combine, CombineRule::max);
  EXPECT_EQ(over.friction.mu, 0.2);
  EXPECT_TRUE(method_use(over).overridden.empty());
  for (const char* none :
       {"/friction/mu=0", "/friction/combine=min"}) {  // without a coefficient it says nothing
    const RunConfig plain = parsed(pure("ando2024"), {none});
    EXPECT_EQ(plain.friction.law, "smoothed_coulomb");
    EXPECT_FALSE(plain.friction.refresh);
    EXPECT_TRUE(method_use(plain).overridden.empty());
  }
  expect_violation(pure_with("ipc2020", "/friction/mu", 0.3), "/friction/mu", "0.3",
                   "0 with method ipc2020, whose file states nothing about friction");
}

// A family reads only the sections that changed.
TEST(Methods, AFamilyHasTheFrictionOfEachOfItsConfigs) {
  const TemporaryFolder folder;
  const std::string path = (folder / "config.json").string();
  std::ofstream(path) << pure("ando2024").dump();
  ConfigFamily family(path);
  for (const double mu : {0.3, 0.0, 0.2}) {
    const std::vector<std::string> overrides = {"/friction/mu=" + json(mu).dump()};
    const RunConfig& read = family.read(overrides);
    EXPECT_EQ(config_id(read), config_id(load_config(path, overrides))) << mu;
    EXPECT_EQ(family.identity().config_id, config_id(load_config(path, overrides))) << mu;
    EXPECT_EQ(read.friction.law, mu > 0 ? "capped" : "smoothed_coulomb");
  }
}

TEST(Methods, AnOverrideThatNamesOneLiesOverTheFileAndUnderTheOthers) {
  json file = with(hang_config(), "/precision", "mixed");
  file["formulation"] = {{"name", "log"}, {"d_hat_m", 0.02}};
  file["strain_limit"] = {{"stiffness_policy", {{"name", "fixed"}, {"k_s_N_per_m", 3}}}};
  for (const std::vector<std::string>& overrides :
       {std::vector<std::string>{"/method=ando2024", "/time/dt_s=0.002"},
        std::vector<std::string>{"/time/dt_s=0.002", "/method=ando2024"}}) {
    const RunConfig config = parsed(file, overrides);
    EXPECT_EQ(config.precision, Precision::single);
    EXPECT_EQ(config.formulation.name, "cubic_dynamic");
    EXPECT_EQ(config.formulation.d_hat, 0.02);
    EXPECT_EQ(config.time.dt, 0.002);
    EXPECT_EQ(method_use(config).overridden, std::vector<std::string>{"/time/dt_s"});
  }
}

TEST(Methods, OnlyTheHighestCounts) {
  const TemporaryFolder folder;
  std::ofstream(folder / "base.json") << pure_with("ando2024", "/seeds/main", 7).dump();
  std::ofstream(folder / "over.json") << R"({"extends": "base.json", "method": "ipc2020"})";
  std::ofstream(folder / "plain.json") << R"({"extends": "base.json", "precision": "double"})";
  const RunConfig over = load_config((folder / "over.json").string());
  EXPECT_EQ(over.method, "ipc2020");
  EXPECT_EQ(over.seeds.main, 7u);
  EXPECT_EQ(over.precision, Precision::full);
  EXPECT_TRUE(method_use(over).overridden.empty());
  EXPECT_EQ(resolved_json(
                load_config((folder / "base.json").string(), std::vector<std::string>{"/method=ipc2020"})),
            resolved_json(over));
  const RunConfig plain = load_config((folder / "plain.json").string());
  EXPECT_EQ(method_use(plain).overridden, std::vector<std::string>{"/precision"});
}

TEST(Methods, AnUnknownNameIsNamed) {
  expect_violation(asked_for("ando2023"), "/method", "\"ando2023\"",
                   "one of ando2024, ipc2020 (did you mean ando2024?)");
  expect_violation(with(hang_config(), "/method", 3), "/method", "3", "one of ando2024, ipc2020");
  const std::vector<Violation> violations = violations_of(hang_config().dump(), {"/method=ando"});
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].where, "a.json#/method");
  EXPECT_EQ(violations[0].found, "\"ando\"");
}

/// A folder of configs whose methods are those of a test.
class MethodFile : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "methods");
    fs::create_directory_symlink(fs::path(configs_folder()) / "formulations", folder_ / "formulations");
    ::setenv("BARRIERBENCH_CONFIGS", folder_.path().c_str(), 1);
  }
  void TearDown() override { ::unsetenv("BARRIERBENCH_CONFIGS"); }

  /// What is reported of a file m.json.
  std::vector<Violation> said(const json& file) const {
    std::ofstream(folder_ / "methods/m.json") << file.dump();
    try {
      load_method("m");
    } catch (const ConfigError& error) {
      return {error.violations().begin(), error.violations().end()};
    }
    return {};
  }
  void expect_said(const json& file, const std::string& where, const std::string& allowed) const {
    const std::vector<Violation> found = said(file);
    ASSERT_EQ(found.size(), 1u) << file;
    EXPECT_EQ(found[0].where, (folder_ / "methods/m.json").string() + "#" + where);
    EXPECT_NE(found[0].allowed.find(allowed), std::string::npos) << found[0].allowed;
  }

  const json whole_ = {{"schema", "barrierbench.method/1"},
                       {"name", "m"},
                       {"doc", "one"},
                       {"source", "a paper"},
                       {"set", {{"/time/dt_s", 0.001}}},
                       {"because", {{"/time/dt_s", "a fact"}}},
                       {"differs", json::object()}};
  TemporaryFolder folder_;
};

TEST_F(MethodFile, SaysWhatIsWrongWithIt) {
  EXPECT_TRUE(said(whole_).empty());
  json file = whole_;
  file.erase("source");
  expect_said(file, "/source", "a string that is not empty");
  expect_said(with(with(whole_, "/formulation", "x"), "/name", "n"), "/formulation", "schema");
  file = whole_;
  file["name"] = "n";
  expect_said(file, "/name", "\"m\", as its file");
  file = whole_;
  file["because"] = json::object();
  expect_said(file, "/because", "/time/dt_s");
  file = whole_;
  file["because"]["/time/steps"] = "a fact";
  expect_said(file, "/because", "a pointer of set");
  file = whole_;
  file["because"]["/time/dt_s"] = 3;
  expect_said(file, "/because/~1time~1dt_s", "a text");
  for (const char* pointer : {"/scene/name", "/passes/time", "/formulation"}) {
    file = whole_;
    file["set"][pointer] = pointer == std::string("/passes/time") ? json(true) : json("log");
    file["because"][pointer] = "a fact";
    const std::vector<Violation> found = said(file);
    ASSERT_FALSE(found.empty()) << pointer;
    EXPECT_NE(found[0].allowed.find("a setting below one of contact, formulation"), std::string::npos)
        << pointer;
  }
  file = whole_;
  file["set"]["time"] = 3;
  file["because"]["time"] = "a fact";
  expect_said(file, "/set", "a JSON pointer into the config");
  file = whole_;
  file["set"] = {{"/time/dt", 0.001}};
  file["because"] = {{"/time/dt", "a fact"}};
  expect_said(file, "/set/time/dt", "dt_s");
}

TEST(Duration, DecidesTheSteps) {
  const auto steps = [](double duration, double dt) {
    json config = with(hang_config(), "/time", {{"duration_s", duration}, {"dt_s", dt}});
    return parsed(config).time.steps;
  };
  EXPECT_EQ(steps(0.4, 0.001), 400);  // 0.4/0.001 is more than 400 in doubles
  EXPECT_EQ(steps(0.3, 0.1), 3);
  EXPECT_EQ(steps(0.301, 0.1), 4);
  EXPECT_EQ(steps(1e-5, 0.1), 1);
  const RunConfig config = parsed(with(hang_config(), "/time", {{"duration_s", 0.301}, {"dt_s", 0.1}}));
  EXPECT_EQ(end_time(config.time), 0.301);
  EXPECT_EQ(json::parse(resolved_json(config))["time"],
            json({{"duration_s", 0.301}, {"dt_s", 0.1}, {"steps", 4}}));
  EXPECT_EQ(end_time(parsed(with(hang_config(), "/time", {{"steps", 3}, {"dt_s", 0.5}})).time), 1.5);
}

TEST(Duration, AndStepsHaveToAgree) {
  const json both = with(hang_config(), "/time", {{"duration_s", 0.4}, {"dt_s", 0.01}, {"steps", 40}});
  EXPECT_EQ(parsed(both).time.steps, 40);
  expect_violation(with(both, "/time/steps", 41), "/time/steps", "41",
                   "40, which is ceil(duration_s/dt_s), or only one");
  expect_violation(with(hang_config(), "/time/duration_s", 1e8), "/time/duration_s", "100000000.0",
                   "at most 1000000000 steps");
}

TEST(Duration, ReplacesStepsFromBelowAndIsReplaced) {
  const json steps = with(hang_config(), "/time", {{"steps", 7}, {"dt_s", 0.01}});
  const RunConfig longer = parsed(steps, {"/time/duration_s=0.2"});
  EXPECT_EQ(longer.time.steps, 20);
  const json resolved = json::parse(resolved_json(longer));
  EXPECT_EQ(parsed(resolved, {"/time/dt_s=0.005"}).time.steps, 40);
  const RunConfig back = parsed(resolved, {"/time/steps=3"});
  EXPECT_EQ(back.time.steps, 3);
  EXPECT_FALSE(back.time.duration.has_value());
  EXPECT_EQ(parsed(steps, {"/time/dt_s=0.005"}).time.steps, 7);
}

TEST(Duration, OfASceneIsThatOfAMethodToo) {
  const RunConfig plain = parsed(hang_config()), method = parsed(pure("ando2024"));
  EXPECT_DOUBLE_EQ(end_time(method.time), end_time(plain.time));
  EXPECT_EQ(method.time.steps, 10 * plain.time.steps);
  EXPECT_EQ(parsed(pure_with("ando2024", "/time/steps", 5)).time.steps, 5);
  // steps of a dt that the method replaces stand for their time
  const json steps = with(hang_config(), "/time", {{"steps", 7}, {"dt_s", 0.01}});
  EXPECT_DOUBLE_EQ(end_time(parsed(steps, {"/method=ando2024"}).time), 0.07);
  const json of_scene = with(hang_config(), "/time", {{"steps", 7}});
  EXPECT_EQ(parsed(of_scene, {"/method=ando2024"}).time.steps, 7 * 10);
  EXPECT_EQ(parsed(steps, {"/method=ando2024", "/time/steps=5"}).time.steps, 5);
  EXPECT_EQ(parsed(steps, {"/method=ipc2020"}).time.steps, 7);  // has no dt of its own
  json bodies = bodies_config();
  bodies["time"] = {{"dt_s", 0.01}};
  expect_violation(bodies, "/time/steps", "nothing", "a value, or duration_s");
  bodies["time"]["duration_s"] = 0.05;
  EXPECT_EQ(parsed(bodies).time.steps, 5);
}

}  // namespace
}  // namespace bb::test::methods_test
