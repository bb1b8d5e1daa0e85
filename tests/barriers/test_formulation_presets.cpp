// The presets of configs/formulations name what exists and mean what their publications wrote.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "barriers/matching.hpp"
#include "barriers/stiffness/registry.hpp"
#include "tests/barriers/barrier_cases.hpp"
#include "tests/folders.hpp"

namespace bb::test::formulation_presets_test {
namespace {

using nlohmann::json;
const std::filesystem::path folder = std::filesystem::path(BB_SOURCE_DIR) / "configs" / "formulations";

json formulation(const std::string& name) {
  std::ifstream file(folder / (name + ".json"));
  return json::parse(file).at("formulation");
}

/// kappa at d_hat = 1 mm from a constant, whatever its convention.
double kappa_of(const std::string& key, double value) {
  const KappaConvention* convention = find_named(kappa_conventions(), key);
  return convention ? convention->kappa(value, 1e-3) : value;
}

TEST(FormulationPresets, EveryFileNamesKnownParts) {
  int files = 0;
  std::set<std::string> shapes_used;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path());
    const json preset = json::parse(file);
    EXPECT_EQ(preset.at("name"), entry.path().stem().string());
    EXPECT_FALSE(preset.at("doc").get<std::string>().empty());
    const json& f = preset.at("formulation");
    EXPECT_NO_THROW(require_shape(f.at("shape").get<std::string>())) << entry.path();
    EXPECT_NO_THROW(require_argument(f.at("argument").get<std::string>())) << entry.path();
    shapes_used.insert(f.at("shape").get<std::string>());

    const json& policy = f.at("stiffness_policy");
    PolicyConfig config;
    config.name = policy.at("name");
    for (const auto& [key, value] : policy.items()) {
      if (key.starts_with("kappa_")) config.parameters["kappa_N_per_m"] = kappa_of(key, value);
      if (key == "mass_term" || key == "refresh" || key == "derivative")
        config.parameters[key] = value.get<std::string>();
    }
    EXPECT_NO_THROW(make_policy(config)) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 13);
  EXPECT_GE(shapes_used.size(), 6u);
}

TEST(FormulationPresets, PublishedOnesAreWhatTheyClaim) {
  const json ipc = formulation("ipc2020");
  EXPECT_EQ(ipc.at("shape"), "log");
  EXPECT_EQ(ipc.at("argument"), "squared_gap");
  EXPECT_EQ(ipc.at("stiffness_policy").at("name"), "ipc_adaptive");

  const json dynamic = formulation("cubic_dynamic"), lagged = formulation("cubic_dynamic_lagged");
  EXPECT_EQ(dynamic.at("stiffness_policy").at("mass_term"), "paper");
  EXPECT_EQ(dynamic.at("stiffness_policy").at("refresh"), "per_iteration");
  EXPECT_EQ(lagged.at("stiffness_policy").at("refresh"), "per_step");
  json same = lagged;
  same["stiffness_policy"]["refresh"] = "per_iteration";
  EXPECT_EQ(same, dynamic);

  const json consistent = formulation("cubic_dynamic_consistent");
  json published = consistent;
  EXPECT_EQ(published["stiffness_policy"]["derivative"], "included");
  published["stiffness_policy"].erase("derivative");
  EXPECT_EQ(published, lagged);
  json sister = formulation("cubic_dynamic_consistent_scaled");
  EXPECT_EQ(sister["stiffness_policy"]["mass_term"], "scaled");
  sister["stiffness_policy"]["mass_term"] = "paper";
  EXPECT_EQ(sister, consistent);

  // at d_hat = 1 mm the literal constants are near the 1000 N/m of the plain presets
  EXPECT_DOUBLE_EQ(kappa_of("kappa_a_J", formulation("article_cubic").at("stiffness_policy").at("kappa_a_J")),
                   1500);
  EXPECT_DOUBLE_EQ(
      kappa_of("kappa_p_N", formulation("quadratic_as_printed").at("stiffness_policy").at("kappa_p_N")),
      1000);
}

}  // namespace
}  // namespace bb::test::formulation_presets_test
