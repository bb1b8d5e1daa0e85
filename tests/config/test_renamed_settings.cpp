// Settings with an earlier name: configs may have either name, records and ids of runs have the earlier one.
#include <fstream>

#include "experiments/config/config_list.hpp"
#include "tests/config/config_text.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::test::renamed_settings_test {
namespace {

struct Renamed {
  std::string section, present, earlier;
  json present_value, earlier_value;
};

const std::vector<Renamed>& renamed() {
  static const std::vector<Renamed> all = {{"contact", "min_gap_fraction", "ccd_park", 1e-5, 1e-5},
                                           {"diagnose", "estimator", "tier", "lanczos", 4}};
  return all;
}

json with_setting(const std::string& section, const std::string& name, const json& value) {
  return with(hang_config(), "/" + section, {{name, value}});
}

TEST(RenamedSettings, BothNamesAreOneSettingAndRecordsHaveTheEarlierName) {
  for (const Renamed& one : renamed()) {
    const RunConfig present = parsed(with_setting(one.section, one.present, one.present_value));
    const RunConfig earlier = parsed(with_setting(one.section, one.earlier, one.earlier_value));
    EXPECT_EQ(resolved_json(present), resolved_json(earlier)) << one.present;
    const json recorded = json::parse(resolved_json(present))[one.section];
    EXPECT_EQ(recorded.value(one.earlier, json()), one.earlier_value);
    EXPECT_FALSE(recorded.contains(one.present));
    EXPECT_EQ(settings_document(present)[one.section].value(one.present, json()), one.present_value);
    EXPECT_EQ(resolved_json(parse_config(resolved_json(present), "resolved")), resolved_json(present));
  }
}

/// The ids that these two configs had before their settings were renamed.
TEST(RenamedSettings, IdsOfRunsAreThoseOfBefore) {
  EXPECT_EQ(config_id(parsed(hang_config())),
            "2959b6a3c1d1ee761e79bb400f97441fe06e139544ecb25abf388908aad43e4c");
  EXPECT_EQ(config_id(parsed(with_setting("contact", "ccd_park", 1e-5))),
            "cbd86876a6414f041d57123f1644707354d2a8e789dfe405c68343671c6ec08e");
}

TEST(RenamedSettings, AnOverrideMayHaveEitherName) {
  for (const Renamed& one : renamed()) {
    const std::string section = "/" + one.section, id = config_id(parsed(hang_config()));
    const std::string present = section + "/" + one.present + "=" + one.present_value.dump();
    const std::string earlier = section + "/" + one.earlier + "=" + one.earlier_value.dump();
    const std::string whole = section + "=" + json{{one.earlier, one.earlier_value}}.dump();
    const std::string expected = config_id(parsed(hang_config(), {present}));
    EXPECT_NE(expected, id);
    EXPECT_EQ(config_id(parsed(hang_config(), {earlier})), expected);
    EXPECT_EQ(config_id(parsed(hang_config(), {whole})), expected);
  }
}

TEST(RenamedSettings, ALaterOverrideWinsUnderEitherName) {
  const RunConfig config =
      parsed(hang_config(), {"/contact/min_gap_fraction=1e-3", "/contact/ccd_park=1e-5"});
  EXPECT_EQ(config.contact.min_gap_fraction, 1e-5);
}

TEST(RenamedSettings, AConfigThatIsExtendedMayHaveTheEarlierName) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "base.json") << with_setting("contact", "ccd_park", 1e-3);
  const json above = {{"schema", "barrierbench.config/1"},
                      {"extends", "base.json"},
                      {"contact", {{"min_gap_fraction", 1e-5}}}};
  EXPECT_EQ(parse_config(above.dump(), "a.json", folder.path().string()).contact.min_gap_fraction, 1e-5);
}

TEST(RenamedSettings, BothNamesAtOnceAreRefused) {
  for (const Renamed& one : renamed()) {
    json config = with_setting(one.section, one.present, one.present_value);
    config[one.section][one.earlier] = one.earlier_value;
    expect_violation(config, "/" + one.section, one.earlier + " and " + one.present,
                     one.earlier + " is the earlier name of " + one.present);
  }
}

TEST(RenamedSettings, AWrongValueUnderTheEarlierNameIsNamedUnderThePresentOne) {
  expect_violation(with_setting("diagnose", "tier", 5), "/diagnose/estimator", "5", "one of ritz");
  expect_violation(with_setting("contact", "ccd_park", 5), "/contact/min_gap_fraction", "5", "<= 0.1");
}

TEST(RenamedSettings, TheSchemaHasBothNames) {
  const json schema = schema_document("config");
  for (const Renamed& one : renamed()) {
    const json& section = schema["properties"][one.section];
    EXPECT_TRUE(section["properties"].contains(one.present)) << one.present;
    EXPECT_TRUE(section["properties"].contains(one.earlier)) << one.earlier;
    EXPECT_EQ(section["not"]["required"], json({one.earlier, one.present}));
  }
}

TEST(RenamedSettings, AnEarlierNameOfAFileOrAnOverrideIsNoted) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "a.json").string();
  const auto noted = [&](const json& config, const std::vector<std::string>& overrides) {
    std::ofstream(path) << config;
    testing::internal::CaptureStderr();
    load_config(path, overrides);
    return testing::internal::GetCapturedStderr();
  };
  const std::string note = "note: /contact/ccd_park is now /contact/min_gap_fraction\n";
  EXPECT_EQ(noted(with_setting("contact", "ccd_park", 1e-5), {}), note);
  EXPECT_EQ(noted(hang_config(), {"/contact/ccd_park=1e-5"}), note);
  EXPECT_EQ(noted(with_setting("contact", "min_gap_fraction", 1e-5), {"/diagnose/estimator=lanczos"}), "");
}

}  // namespace
}  // namespace bb::test::renamed_settings_test
