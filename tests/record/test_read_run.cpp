// A record is read by the list of its fields: every fault is named with its place.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "tests/record/sample_record.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::read_run_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::optional<RunRecord> read(const Json& record) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "run.json") << record;
  return read_run(folder / "run.json");
}

/// What the reader reports of it; empty when it reads it.
std::string refusal(const Json& record) {
  try {
    EXPECT_TRUE(read(record).has_value());
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

Json sample() { return Json::parse(to_json(test::sample_record())); }

/// Pointers to every field of `j` and of what is in it, but for those inside the config and the phases.
void collect(const Json& j, const std::string& place, std::vector<std::string>& out) {
  if (!j.is_structured() || place == "/config" || place.ends_with("/time")) return;
  for (const auto& [key, value] : j.items()) {
    const std::string at = place + (Json::json_pointer() / key).to_string();
    if (!key.ends_with("_status") || key == "linear_status") out.push_back(at);
    collect(value, at, out);
  }
}

TEST(ReadRun, GivesBackWhatWasWritten) {
  const Json written = sample();
  const auto record = read(written);
  ASSERT_TRUE(record);
  EXPECT_EQ(Json::parse(to_json(*record)), written);
  EXPECT_EQ(record->status.outcome, Outcome::newton_stall);
  EXPECT_EQ(record->steps.at(0).status, StepStatus::iteration_cap);
  EXPECT_STREQ(record->steps.at(0).gap_min_m.status, "not_converged");
  EXPECT_EQ(record->steps.at(0).time[Phase::linear_factor], 0.5);
  EXPECT_EQ(record->ids.sweep_id, "strip");
  EXPECT_FALSE(record->ids.rerun_of);
}

TEST(ReadRun, EveryFieldOfAnotherTypeIsNamed) {
  std::vector<std::string> places;
  collect(sample(), "", places);
  std::size_t judged = 0;
  for (const std::string& place : places) {
    if (place.starts_with("/schema")) continue;  // decides whether it is a record at all
    Json record = sample();
    Json& value = record[Json::json_pointer(place)];
    value = value.is_object() ? Json::array() : Json{{"no", "value"}};
    if (place.ends_with("/total")) continue;  // written, not read
    EXPECT_NE(refusal(record).find("#" + place + ": found"), std::string::npos) << place << refusal(record);
    ++judged;
  }
  EXPECT_GT(judged, 190U);
}

TEST(ReadRun, EveryFieldThatIsMissingIsNamedUnlessTheRecordIsOlder) {
  std::vector<std::string> places;
  collect(sample(), "", places);
  const std::set<std::string> entries = {"/samples/wall_s", "/summary/cond/full~1block_jacobi",
                                         "/summary/cond/full~1block_jacobi/statuses/ok"};  // of maps
  std::size_t judged = 0;
  for (const std::string& place : places) {
    const Json::json_pointer pointer(place);
    if (place.starts_with("/schema") || place.ends_with("/total") || place == "/ids/sweep_id") continue;
    Json record = sample();
    Json& parent = record[pointer.parent_pointer()];
    if (parent.is_array() || entries.contains(place)) continue;
    parent.erase(pointer.back());
    EXPECT_NE(refusal(record).find("#" + place + ": found nothing"), std::string::npos) << place;
    record["schema"]["version"] = "3.0.-1";  // before the first one of this model
    EXPECT_EQ(refusal(record), "") << place;
    ++judged;
  }
  EXPECT_GT(judged, 180U);
}

TEST(ReadRun, AnUnknownFieldIsLeftOut) {
  Json record = sample();
  record["summary"]["a_field_of_a_later_version"] = 1;
  record["schema"]["version"] = "3.99.0";
  const auto out = read(record);
  ASSERT_TRUE(out);
  EXPECT_EQ(to_json(*out).find("a_field_of_a_later_version"), std::string::npos);
}

TEST(ReadRun, AnotherModelIsRefusedWithBothVersions) {
  for (const char* version : {"2.0.0", "4.0.0", "three", ""}) {
    Json record = sample();
    record["schema"]["version"] = version;
    const std::string text = refusal(record);
    EXPECT_NE(text.find("#/schema/version"), std::string::npos) << text;
    EXPECT_NE(text.find(version), std::string::npos) << text;
    EXPECT_NE(text.find("3.x.y"), std::string::npos) << text;
  }
}

TEST(ReadRun, ANullWithoutAReasonIsRefused) {
  Json record = sample();
  record["steps"][0].erase("gap_min_m_status");
  EXPECT_NE(refusal(record).find("#/steps/0/gap_min_m: found null"), std::string::npos) << refusal(record);
}

TEST(ReadRun, WhatIsNoRecordIsNothing) {
  EXPECT_FALSE(read(Json{{"schema", "barrierbench.config/1"}}));
  EXPECT_FALSE(read(Json::array()));
  const test::TemporaryFolder folder;
  std::ofstream(folder / "run.json") << R"({"schema": )";
  EXPECT_FALSE(read_run(folder / "run.json"));
  EXPECT_FALSE(read_run(folder / "no_file.json"));
}

}  // namespace
}  // namespace bb::read_run_test
