// The resolved config: complete, stable, and the identity of a run.
#include <filesystem>
#include <fstream>

#include "tests/config/config_text.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::test::config_id_test {
namespace {

TEST(ConfigId, DoesNotDependOnTheOrderOfKeys) {
  const char* const one =
      R"({"schema": "barrierbench.config/1", "scene": {"name": "hang", "n": 4, "width_m": 0.5},
          "formulation": "cubic", "time": {"dt_s": 0.005, "steps": 3}})";
  const char* const other =
      R"({"time": {"steps": 3, "dt_s": 5e-3}, "formulation": {"name": "cubic"},
          "scene": {"width_m": 0.5, "n": 4, "name": "hang"}, "schema": "barrierbench.config/1"})";
  EXPECT_EQ(config_id(parse_config(one, "one")), config_id(parse_config(other, "other")));
}

TEST(ConfigId, LabelsAndSpelledOutDefaultsDoNotChangeIt) {
  const std::string id = config_id(parsed(hang_config()));
  EXPECT_EQ(config_id(parsed(with(hang_config(), "/doc", "words"))), id);
  EXPECT_EQ(config_id(parsed(with(hang_config(), "/precision", "double"))), id);
  EXPECT_EQ(config_id(parsed(with(hang_config(), "/contact/min_gap_fraction", 1e-6))), id);
}

TEST(ConfigId, ThreadsDoNotChangeItAndStandInTheResolvedConfig) {
  const RunConfig three = parsed(with(hang_config(), "/threads", 3));
  EXPECT_EQ(config_id(three), config_id(parsed(with(hang_config(), "/threads", 1))));
  EXPECT_EQ(json::parse(resolved_json(three))["threads"], 3);
}

TEST(ConfigId, EverySettingChangesIt) {
  const std::string id = config_id(parsed(hang_config()));
  const std::vector<std::pair<std::string, json>> settings = {{"/scene/n", 5},
                                                              {"/formulation/d_hat_m", 0.0123},
                                                              {"/time/dt_s", 0.0123},
                                                              {"/time/steps", 3},
                                                              {"/seeds/main", 2},
                                                              {"/contact/min_gap_fraction", 1e-5},
                                                              {"/integrator/name", "bdf2"},
                                                              {"/passes/audit", false},
                                                              {"/formulation/name", "cubic"},
                                                              {"/matching/theta", 0.5},
                                                              {"/linear_solver/name", "pcg"}};
  for (const auto& [pointer, value] : settings) {
    EXPECT_NE(config_id(parsed(with(hang_config(), pointer, value))), id) << pointer;
  }
}

TEST(ConfigId, AResolvedConfigIsItsOwnResolution) {
  const json bounds = {{"name", "ipc_adaptive"},
                       {"kappa_min_N_per_m", 5},
                       {"kappa_max_N_per_m", 50},
                       {"doubling_gap_m", 1e-9}};
  std::vector<json> configs = {hang_config(), bodies_config(),
                               with(hang_config(), "/formulation/stiffness_policy", bounds)};
  EXPECT_EQ(json::parse(resolved_json(parsed(configs.back())))["formulation"]["stiffness_policy"],
            json::parse(R"({"name": "ipc_adaptive", "scale": 1.0, "kappa_min_N_per_m": 5.0,
                            "kappa_max_N_per_m": 50.0, "doubling_gap_m": 1e-9})"));
  for (const auto& file : std::filesystem::directory_iterator(configs_folder() + "/formulations")) {
    configs.push_back(with(hang_config(), "/formulation", file.path().stem().string()));
  }
  ASSERT_GT(configs.size(), 8u);
  for (const json& config : configs) {
    const std::string resolved = resolved_json(parsed(config));
    const RunConfig again = parse_config(resolved, "resolved");
    EXPECT_EQ(resolved_json(again), resolved) << config;
    EXPECT_EQ(config_id(again), config_id(parsed(config)));
  }
}

TEST(ConfigId, EverySceneFileResolvesToItself) {
  int n = 0;
  for (const auto& file : std::filesystem::directory_iterator(configs_folder() + "/scenes")) {
    if (!file.is_regular_file()) continue;  // the meshes
    const RunConfig config = load_config(file.path().string());
    EXPECT_EQ(resolved_json(parse_config(resolved_json(config), "resolved")), resolved_json(config))
        << file.path();
    ++n;
  }
  EXPECT_GT(n, 3);
}

TEST(ConfigId, ExtendsIsLaidUnderneath) {
  const TemporaryFolder folder;
  std::ofstream(folder / "base.json") << with(hang_config(), "/time/steps", 7).dump();
  std::ofstream(folder / "loop.json") << R"({"extends": "loop.json"})";
  std::ofstream(folder / "over.json") << R"({"extends": "base.json", "time": {"dt_s": 0.005}})";

  const RunConfig config = load_config((folder / "over.json").string());
  EXPECT_EQ(config.time.steps, 7);
  EXPECT_EQ(config.time.dt, 0.005);
  EXPECT_THROW(load_config((folder / "loop.json").string()), ConfigError);
  EXPECT_THROW(parse_config(R"({"extends": "nowhere.json"})", "a", folder.path()), ConfigError);
}

}  // namespace
}  // namespace bb::test::config_id_test
