// The solid scenes of configs/scenes as their users run them: contacts are active, nothing crosses, and what has to come out does.
#include <gtest/gtest.h>

#include <filesystem>

#include "experiments/config/parse.hpp"
#include "experiments/run/runner.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::solid_scenes_test {
namespace {

RunRecord run_solid(const std::string& name, std::vector<std::string> overrides) {
  overrides.emplace_back("/passes={\"time\": true, \"diagnose\": false, \"audit\": true}");
  RunOptions options;
  const test::TemporaryFolder folder;
  options.folder = folder;
  const RunRecord record =
      run_config(load_config(configs_folder() + "/scenes/" + name + ".json", overrides), options);
  EXPECT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
  EXPECT_GT(record.audit.judged, 0);
  EXPECT_EQ(record.audit.crossings + record.audit.violations + record.audit.unproven, 0);
  EXPECT_GT(record.scene.tetrahedra, 100u);
  EXPECT_EQ(record.scene.triangles, 0u);
  return record;
}

TEST(SolidScenes, the_stack_carries_its_weight_through_two_contacts) {
  const RunRecord record = run_solid("solid_stack", {});
  for (const char* pair : {"floor|lower", "lower|upper"}) {
    EXPECT_TRUE(record.summary.first_contact.contains(pair)) << pair;
  }
  const double upper = 9.81 * 1000 * 0.16 * 0.16 * 0.16, both = upper + 9.81 * 1000 * 0.24 * 0.24 * 0.16;
  EXPECT_NEAR(record.steps.back().contact_load_sum_N.value, upper + both, 0.2 * both);
  EXPECT_GT(record.steps.back().contacts.total(), 20u);
  EXPECT_GT(record.summary.gap_min_m.value, 0);
}

TEST(SolidScenes, the_ball_lands_and_leaves_the_floor_again) {
  const RunRecord record = run_solid("solid_ball", {"/time/steps=30"});
  EXPECT_GT(record.summary.contacts.max.value, 10);
  EXPECT_EQ(record.steps.front().contacts.total(), 0u);
  EXPECT_EQ(record.steps.back().contacts.total(), 0u);
}

TEST(SolidScenes, the_cantilever_swings_without_contact) {
  const RunRecord record = run_solid("solid_cantilever", {"/time/steps=20"});
  EXPECT_EQ(record.summary.contacts.max.value, 0);
}

}  // namespace
}  // namespace bb::solid_scenes_test
