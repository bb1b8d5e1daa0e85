// The contacts of a scene at its start, counted before a run.
#include "experiments/run/contact_count.hpp"
#include "experiments/run/method.hpp"

#include <gtest/gtest.h>

#include "core/contact/contact_system.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/plan.hpp"
#include "tests/folders.hpp"

namespace bb::contact_count_test {
namespace {

/// configs/gpu/packed_8m.json with fewer cloths of fewer vertices at its mesh size.
RunConfig packed(int layers, int n) {
  const std::vector<std::string> smaller = {"/scene/layers=" + std::to_string(layers),
                                            "/scene/n=" + std::to_string(n),
                                            "/scene/width_m=" + std::to_string((n - 1) / 505.0)};
  return load_config(std::string(BB_SOURCE_DIR) + "/configs/gpu/packed_8m.json", smaller);
}

StartContacts counted(const RunConfig& config, std::size_t most_counted = 20000) {
  const Scene scene = build_scene(config);
  return contacts_at_start(scene, plan_of(config, scene).contacts, contact_options(config.contact),
                           most_counted);
}

TEST(ContactCount, TheSceneOf184MillionContactsHasMoreThanTwentyAVertex) {
  const StartContacts found = counted(packed(16, 32));
  EXPECT_EQ(found.sampled, 16u * 32 * 32);
  EXPECT_GE(found.a_vertex, 20);
  EXPECT_LE(found.a_vertex, 23);
}

TEST(ContactCount, IsThatOfTheRowsOfAWholeSystem) {
  const RunConfig config = packed(4, 12);
  const Scene scene = build_scene(config);
  ContactSystem contacts(scene, contact_options(config.contact));
  contacts.update_candidates(scene.x0, scene.x0);
  ContactTable rows;
  MollifiedTable mollified;
  contacts.find_rows(scene.x0, rows, mollified);
  EXPECT_GT(rows.size(), 1000u);
  EXPECT_DOUBLE_EQ(counted(config).total, static_cast<double>(rows.size() + mollified.stencil.size() / 4));
}

TEST(ContactCount, ASampleIsNearTheWhole) {
  const RunConfig config = packed(8, 26);
  const StartContacts all = counted(config), some = counted(config, 100);
  EXPECT_EQ(all.sampled, 8u * 26 * 26);
  EXPECT_NE(some.sampled, all.sampled);
  EXPECT_NEAR(some.a_vertex, all.a_vertex, 0.1 * all.a_vertex);
}

TEST(ContactCount, LayersThatDoNotTouchHaveNone) {
  const std::vector<std::string> apart = {"/scene/spacing_d_hat=1.5"};
  const RunConfig config = load_config(std::string(BB_SOURCE_DIR) + "/configs/gpu/dense_patch.json", apart);
  EXPECT_EQ(counted(config).total, 0);
}

}  // namespace
}  // namespace bb::contact_count_test
