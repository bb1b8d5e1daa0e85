// linear_solver: auto: which solver a model of this processor makes of it, and models that cannot be read.
#include "experiments/run/linear_choice.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/math/error.hpp"
#include "core/record/provenance.hpp"
#include "core/solvers/linear_solvers.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/plan.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::linear_choice_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json seconds_each(double solve, double factor_flop) {
  return {{"solve", solve},
          {"entry", 0},
          {"entry_sqrt_unknown", 0},
          {"factor_entry", 0},
          {"factor_flop", factor_flop}};
}

/// pcg takes 1e-3 s whatever the size; cholmod 1e-9 s an operation: pcg from a million operations on.
json model_of(const std::string& cpu) {
  return {{"schema", "barrierbench.linear_model/1"},
          {"machine", {{"cpu_model", cpu}}},
          {"costs",
           {{{"solver", "cholmod"}, {"seconds_each", seconds_each(0, 1e-9)}},
            {{"solver", "pcg"}, {"preconditioner", "ic0"}, {"seconds_each", seconds_each(1e-3, 0)}}}}};
}

/// A folder of configs of its own, with the presets of the real one.
class LinearChoiceTest : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path presets = fs::path(configs_folder()) / "formulations";
    fs::create_directory_symlink(presets, folder_ / "formulations");
    fs::create_directory(folder_ / "linear_models");
    ::setenv("BARRIERBENCH_CONFIGS", folder_.path().c_str(), 1);
  }
  void TearDown() override { ::unsetenv("BARRIERBENCH_CONFIGS"); }
  std::string write(const json& model, const std::string& name = "one.json") const {
    const fs::path file = folder_ / "linear_models" / name;
    std::ofstream(file) << model.dump();
    return file.string();
  }
  static Plan planned(int n) {
    const std::string text =
        R"({"schema": "barrierbench.config/1", "formulation": "log", "scene": {"name": "hang", "n": )" +
        std::to_string(n) + "}}";
    const std::vector<std::string> overrides = {"/linear_solver/name=auto",
                                                "/linear_solver/max_iterations=77"};
    RunConfig config = parse_config(text, "test", ".", overrides);
    decide_linear_solver(config);
    return plan_of(config, build_scene(config));
  }
  /// The message of the model that is refused.
  std::string refusal(const json& model) const {
    try {
      read_linear_model(write(model));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "not refused";
  }
  test::TemporaryFolder folder_;
};

TEST_F(LinearChoiceTest, TheModelOfThisProcessorChoosesByTheSizeOfTheScene) {
  write(model_of(collect_machine().cpu_model));
  const Plan small = planned(4), large = planned(40);
  EXPECT_EQ(small.linear.name, "cholmod");
  EXPECT_EQ(large.linear.name, "pcg");
  EXPECT_EQ(preconditioner_of(large.linear), "ic0");
  EXPECT_EQ(integer(large.linear.parameters, "max_iterations"), 77);  // the rest is the config's
  EXPECT_TRUE(large.preconditioner.needed);
  EXPECT_TRUE(large.linear_solver.reason.starts_with(
      "pcg, by auto: a solve is expected to take pcg with ic0 0.001 s, "
      "cholmod 0."))
      << large.linear_solver.reason;
  EXPECT_NE(large.linear_solver.reason.find("one.json"), std::string::npos);
}

TEST_F(LinearChoiceTest, APreconditionerIsGivenToItsSolverUnderTheNameThatItHasThere) {
  json model = model_of(collect_machine().cpu_model);
  model["costs"][1]["solver"] = "pcg_resident";
  model["costs"][1]["preconditioner"] = "schwarz";
  write(model);
  const Plan large = planned(40);
  EXPECT_EQ(large.linear.name, "pcg_resident");
  EXPECT_EQ(text(large.linear.parameters, "resident_preconditioner"), "schwarz");
  EXPECT_EQ(preconditioner_of(large.linear), "schwarz");
  EXPECT_EQ(preconditioner_of({"pcg_resident", {}}), "block_jacobi");
  EXPECT_EQ(preconditioner_of({"pcg", {}}), "block_jacobi");
  EXPECT_EQ(preconditioner_of({"cholmod", {}}), "none");
}

TEST_F(LinearChoiceTest, WithoutAModelOfThisProcessorItSaysForWhichThereAreSome) {
  write(model_of("another processor"));
  try {
    planned(4);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/linear_solver/name: found auto without a model for this machine (" +
                        collect_machine().cpu_model),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("fit-linear"), std::string::npos);
    EXPECT_NE(text.find("another processor"), std::string::npos);
  }
}

TEST_F(LinearChoiceTest, TheFirstOfSeveralModelsCountsByTheNamesOfTheFiles) {
  json second = model_of(collect_machine().cpu_model);
  second["costs"] = {second["costs"][1]};
  write(second, "two.json");
  write(model_of(collect_machine().cpu_model), "one.json");
  EXPECT_EQ(planned(4).linear.name, "cholmod");
}

TEST_F(LinearChoiceTest, AModelThatCannotBeReadIsNamedWithPlaceValueAndWhatIsAllowed) {
  const json good = model_of("any");
  ASSERT_EQ(refusal(good), "not refused");
  json negative = good, unknown = good, without = good, with = good, none = good, missing = good;
  negative["costs"][0]["seconds_each"]["solve"] = -1;
  EXPECT_NE(refusal(negative).find("one.json#/costs/0/seconds_each/solve: found -1"), std::string::npos);
  unknown["costs"][0]["solver"] = "cholmd";
  EXPECT_NE(refusal(unknown).find("did you mean cholmod"), std::string::npos);
  without["costs"][1].erase("preconditioner");
  EXPECT_NE(refusal(without).find("/costs/1/preconditioner: found nothing"), std::string::npos);
  with["costs"][0]["preconditioner"] = "ic0";
  EXPECT_NE(refusal(with).find("/costs/0/preconditioner: found \"ic0\"; allowed: nothing"),
            std::string::npos);
  json foreign = good;
  foreign["costs"][1]["solver"] = "pcg_resident";
  EXPECT_NE(refusal(foreign).find("/costs/1/preconditioner: found \"ic0\"; allowed: a preconditioner that "
                                  "pcg_resident has: block_jacobi, schwarz"),
            std::string::npos)
      << refusal(foreign);
  none["costs"] = json::array();
  EXPECT_NE(refusal(none).find("#/costs"), std::string::npos);
  missing["costs"][0]["seconds_each"].erase("entry");
  EXPECT_NE(refusal(missing).find("/costs/0/seconds_each"), std::string::npos);
}

}  // namespace
}  // namespace bb::linear_choice_test
