// Schemas and dictionary against the lists of fields.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/base/record/run_record.hpp"
#include "core/base/record/schema.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/folders.hpp"

namespace bb::schema_text_test {
namespace {

using nlohmann::json;

std::string committed(const char* name) {
  std::ifstream in(std::string(BB_SOURCE_DIR) + "/configs/schema/" + name + ".schema.json");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(RecordSchema, TheCopyInTheTreeIsTheOneOfThisProgram) {
  EXPECT_EQ(committed("run"), run_schema(step_solver_counters()))
      << "write it anew: ./bench help record --schema";
  EXPECT_EQ(committed("trace"), trace_schema()) << "write it anew: ./bench help trace --schema";
}

TEST(RecordSchema, AFieldIsRequiredUnlessItMayBeLeftOut) {
  const json run = json::parse(run_schema(step_solver_counters()));
  const json& ids = run["$defs"]["Ids"];
  const std::set<std::string> required = ids["required"];
  EXPECT_EQ(required, (std::set<std::string>{"config_id", "run_id", "build_id", "machine_id"}));
  EXPECT_TRUE(ids["properties"].contains("rerun_of"));
  const std::set<std::string> sections = run["required"];
  EXPECT_EQ(sections.size(), run["properties"].size());
}

TEST(RecordSchema, SaysWhyANumberMayBeAbsentAndWhatAWordMayBe) {
  const json run = json::parse(run_schema(step_solver_counters()));
  const json& step = run["$defs"]["StepRecord"]["properties"];
  EXPECT_EQ(step["gap_min_m"]["type"], json({"number", "null"}));
  EXPECT_EQ(step["gap_min_m_status"]["enum"],
            json({"no_contacts", "not_converged", "not_measured", "nan", "infinite", "minus_infinite"}));
  EXPECT_EQ(step["kinetic_J_status"]["enum"], json({"nan", "infinite", "minus_infinite"}));
  EXPECT_EQ(step["status"]["enum"].size(), 8U);
  EXPECT_EQ(run["$defs"]["Status"]["properties"]["outcome"]["enum"].back(), "ok");
  EXPECT_EQ(run["$defs"]["AuditRecord"]["properties"]["first_bad_step"]["minimum"], -1);
  EXPECT_EQ(step["linear_solves"]["minimum"], 0);  // of WorkCounts
}

TEST(RecordSchema, TheUnitIsTheEndOfTheName) {
  EXPECT_EQ(unit_of("contact_load_max_N"), "N");
  EXPECT_EQ(unit_of("kappa_min_N_per_m"), "N/m");
  EXPECT_EQ(unit_of("gap_min_m"), "m");
  EXPECT_EQ(unit_of("gap_min_rel"), "1");
  EXPECT_EQ(unit_of("peak_rss_bytes"), "bytes");
  EXPECT_EQ(unit_of("steps"), "");
}

/// Of every field whose values are not compared with those of earlier records: in the schema for readers, in the
/// dictionary for people. A place that is no field would warn nobody.
TEST(RecordSchema, SaysWhichFieldsMeantSomethingElseBefore) {
  const auto expect_said = [](const ChangedMeaning& change, const std::string& schema,
                              const std::string& dictionary) {
    const json said = json::parse(schema)["x-changed-meaning"][change.field];
    EXPECT_EQ(said["since"], change.since) << change.field;
    EXPECT_EQ(said["before"], change.before) << change.field;
    const std::size_t line = ("\n" + dictionary).find("\n" + std::string(change.field) + " ");
    ASSERT_NE(line, std::string::npos) << change.field;
    const std::string text = dictionary.substr(line, dictionary.find('\n', line) - line);
    EXPECT_NE(text.find(std::string(" [before ") + change.since + ": " + change.before + "]"),
              std::string::npos)
        << text;
  };
  for (const ChangedMeaning& change : changed_in_run)
    expect_said(change, run_schema(step_solver_counters()), run_dictionary(step_solver_counters()));
  for (const ChangedMeaning& change : changed_in_trace)
    expect_said(change, trace_schema(), trace_dictionary());
}

TEST(RecordDictionary, HasALineForEveryFieldWithItsMeaning) {
  std::istringstream in(run_dictionary(step_solver_counters()) + trace_dictionary());
  std::set<std::string> places;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string place, rest;
    words >> place;
    std::getline(words, rest);
    EXPECT_TRUE(place.empty() || rest.size() > 3) << line;
    places.insert(place);
  }
  int fields = 0;
  for_each_field<StepRecord>([&](const FieldText& field, auto) {
    EXPECT_TRUE(places.contains(std::string("steps[].") + field.name)) << field.name;
    ++fields;
  });
  EXPECT_GT(fields, 40);
  for (const char* place : {"summary.cond.*.log10_cond.median", "provenance.blas.kernel", "cond[].stage",
                            "alpha_strain", "steps[].time.linear_solve_s", "ids.rerun_of"}) {
    EXPECT_TRUE(places.contains(place)) << place;
  }
}

}  // namespace
}  // namespace bb::schema_text_test
