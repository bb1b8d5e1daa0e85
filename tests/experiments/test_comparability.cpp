// The rule by which runs of a sweep may be compared, and where it is written.
#include "experiments/run/comparability.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/record/folder_lock.hpp"
#include "core/base/record/writer.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::comparability_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

PairGaps gaps(double all, double load_share = 1, double time_share = 1) {
  return {1, load_share, time_share, all, all, all};
}
ComparedRun run(const char* folder, double gap, bool valid = true, const char* shape = "log",
                const char* rule = "equal_force") {
  return {folder, std::string("id_") + folder,  valid ? "ok" : "penetration", shape, "gap", rule, valid,
          gap,    {{"cloth|floor", gaps(gap)}}, valid ? "" : "audit_clean"};
}
ComparedRun untouched(const char* folder) {
  ComparedRun out = run(folder, 0);
  out.gap_rel = Number::missing("no_contacts");
  out.gaps.clear();
  return out;
}
ComparedRun with(const GapMap& gaps) {
  ComparedRun out = run("other", 0.1);
  out.gaps = gaps;
  return out;
}

TEST(Comparability, IsAFactorTwoOfTheReferenceEitherWay) {
  const ComparedRun log = run("log", 0.1);
  const auto verdict = [&](double gap) { return judge_comparability(run("other", gap), log).verdict; };
  EXPECT_EQ(verdict(0.2), "comparable");
  EXPECT_EQ(verdict(0.201), "not_comparable");
  EXPECT_EQ(verdict(0.05), "comparable");
  EXPECT_EQ(verdict(0.0499), "not_comparable");
  const Comparability found = judge_comparability(run("other", 0.15), log);
  EXPECT_EQ(found.reference_run, "log");
  EXPECT_EQ(found.reference_run_id, "id_log");
  EXPECT_DOUBLE_EQ(found.ratio.value, 1.5);
  EXPECT_EQ(found.reference_gap_rel.value, 0.1);
  EXPECT_DOUBLE_EQ(found.pair_ratio.value, 1.5);
  EXPECT_EQ(judge_comparability(log, log).verdict, "comparable");
}

/// Each quantile of each pair has a veto, and the record names the one that is farthest off.
TEST(Comparability, EveryQuantileOfEveryPairIsHeldToTheFactor) {
  const GapMap reference = {{"a|b", gaps(0.3)}, {"cloth|floor", {1, 0.02, 1, 0.1, 0.4, 0.5}}};
  const std::pair<const char*, double PairGaps::*> fields[] = {{"gap_rel_p05", &PairGaps::gap_rel_p05},
                                                               {"gap_rel_median", &PairGaps::gap_rel_median},
                                                               {"gap_rel_p95", &PairGaps::gap_rel_p95}};
  for (const char* pair : {"a|b", "cloth|floor"}) {
    for (const auto& [name, field] : fields) {
      for (const double factor : {1.99, 2.01, 1 / 1.99, 1 / 2.01}) {
        GapMap mine = reference;
        mine.at(pair).*field *= factor;
        const Comparability found = judge_comparability(with(mine), with(reference));
        const bool within = factor < 2 && factor > 0.5;
        EXPECT_EQ(found.verdict, within ? "comparable" : "not_comparable") << pair << name << factor;
        EXPECT_EQ(found.pair, pair);
        EXPECT_EQ(found.pair_quantile, name);
        EXPECT_DOUBLE_EQ(found.pair_ratio.value, factor);
        EXPECT_DOUBLE_EQ(found.pair_reference_gap_rel.value, reference.at(pair).*field);
        EXPECT_DOUBLE_EQ(found.pair_gap_rel.value, mine.at(pair).*field);
      }
    }
  }
  GapMap mine = reference;
  mine.at("a|b").gap_rel_p05 = 0.9;
  ComparedRun log = with(reference);
  log.folder = "log";
  const Comparability found = judge_comparability(with(mine), log);
  EXPECT_NE(found.reason.find("5 % quantile of the gap, a|b: 0.9 d_hat where the reference has 0.3"),
            std::string::npos)
      << found.reason;
}

TEST(Comparability, TheSmallestGapOfARunDecidesNothing) {
  ComparedRun deep = run("deep", 0.1);
  deep.gap_rel = 0.001;
  const Comparability found = judge_comparability(deep, run("log", 0.1));
  EXPECT_EQ(found.verdict, "comparable");
  EXPECT_DOUBLE_EQ(found.ratio.value, 0.01);
}

/// A pair counts from 1 % of the load or 10 % of the time on, in either of the two runs.
TEST(Comparability, APairCountsByItsShareOfLoadOrTime) {
  const auto verdict = [](double load, double time, bool in_reference) {
    const GapMap alone = {{"cloth|floor", gaps(0.3)}};
    GapMap one = alone, other = alone;
    one["a|b"] = gaps(0.2, load, time);
    other["a|b"] = gaps(0.6, 0, 0);
    return judge_comparability(with(in_reference ? other : one), with(in_reference ? one : other)).verdict;
  };
  for (const bool in_reference : {false, true}) {
    EXPECT_EQ(verdict(0.0099, 0.099, in_reference), "comparable");
    EXPECT_EQ(verdict(0.01, 0, in_reference), "not_comparable");
    EXPECT_EQ(verdict(0, 0.1, in_reference), "not_comparable");
  }
}

/// A pair that one of the two runs keeps apart is at d_hat there, or farther.
TEST(Comparability, APairWithLoadInOneRunOnlyCountsAsAtDHatInTheOther) {
  const GapMap alone = {{"cloth|floor", gaps(0.3)}};
  for (const double gap : {0.51, 0.49}) {
    GapMap both = alone;
    both["a|b"] = gaps(gap);
    const char* expected = gap > 0.5 ? "comparable" : "not_comparable";
    const Comparability lost = judge_comparability(with(alone), with(both));
    EXPECT_EQ(lost.verdict, expected);
    EXPECT_EQ(lost.pair, "a|b");
    EXPECT_EQ(lost.pair_gap_rel.value, 1);
    EXPECT_EQ(lost.pair_reference_gap_rel.value, gap);
    const Comparability won = judge_comparability(with(both), with(alone));
    EXPECT_EQ(won.verdict, expected);
    EXPECT_EQ(won.pair_reference_gap_rel.value, 1);
  }
}

/// Loads that are spread so thinly that no pair counts are compared all the same.
TEST(Comparability, WhereNoPairHasEnoughAllCount) {
  GapMap thin, other;
  for (int i = 0; i < 120; ++i) {
    thin["chip " + std::to_string(i) + "|floor"] = gaps(0.3, 1.0 / 120, 0.05);
    other["chip " + std::to_string(i) + "|floor"] = gaps(i == 7 ? 0.7 : 0.3, 1.0 / 120, 0.05);
  }
  EXPECT_EQ(judge_comparability(with(thin), with(thin)).verdict, "comparable");
  const Comparability found = judge_comparability(with(other), with(thin));
  EXPECT_EQ(found.verdict, "not_comparable");
  EXPECT_EQ(found.pair, "chip 7|floor");
  EXPECT_EQ(found.pair_quantile, "gap_rel_p05");
}

TEST(Comparability, SurfacesThatOverlapAreWithinNoFactorOfAnotherRun) {
  const GapMap overlapping = {{"a|b", {1, 1, 1, 0, 0, 0.4}}}, apart = {{"a|b", gaps(0.4)}};
  ComparedRun penalty = with(overlapping), again = with(overlapping), log = with(apart);
  penalty.folder = "penalty", again.folder = "again", log.folder = "log";
  for (const auto& [run, reference] :
       {std::pair(penalty, log), std::pair(log, penalty), std::pair(again, penalty)}) {
    const Comparability found = judge_comparability(run, reference);
    EXPECT_EQ(found.verdict, "not_comparable");
    EXPECT_STREQ(found.pair_ratio.status, "overlap");
    EXPECT_EQ(found.pair_quantile, "gap_rel_p05");
    EXPECT_NE(found.reason.find("surfaces overlap"), std::string::npos) << found.reason;
  }
  const Comparability itself = judge_comparability(penalty, penalty);
  EXPECT_EQ(itself.verdict, "comparable");
  EXPECT_EQ(itself.reason, "the reference itself");
}

/// Two of twenty steps, as their sums are rounded, are a tenth of the time.
TEST(Comparability, ATenthOfTheTimeIsOneWhateverItsRounding) {
  GapMap one = {{"cloth|floor", gaps(0.3)}}, other = one;
  one["a|b"] = gaps(0.2, 0, 0.1 - 2e-17);
  other["a|b"] = gaps(0.6, 0, 0);
  EXPECT_EQ(judge_comparability(with(one), with(other)).verdict, "not_comparable");
}

TEST(Comparability, AnInvalidRunIsNeitherComparedNorAReference) {
  const ComparedRun bad = run("bad", 0.1, false), good = run("good", 0.1);
  EXPECT_EQ(judge_comparability(bad, good).verdict, "not_valid");
  EXPECT_EQ(judge_comparability(bad, std::nullopt).verdict, "not_valid");
  EXPECT_NE(judge_comparability(bad, good).reason.find("failed checks: audit_clean"), std::string::npos);
  EXPECT_EQ(judge_comparability(good, bad).verdict, "no_reference");
  EXPECT_NE(judge_comparability(good, bad).reason.find("penetration"), std::string::npos);
  EXPECT_EQ(judge_comparability(good, std::nullopt).verdict, "no_reference");
}

TEST(Comparability, ARunWithoutContactIsNotComparableToOneWithIt) {
  EXPECT_EQ(judge_comparability(untouched("free"), run("log", 0.1)).verdict, "not_comparable");
  EXPECT_EQ(judge_comparability(run("log", 0.1), untouched("free")).verdict, "no_reference");
  EXPECT_STREQ(judge_comparability(untouched("free"), run("log", 0.1)).ratio.status, "no_reference");
}

TEST(Comparability, DefaultReferenceIsTheLogOfTheSameRuleThatIsValid) {
  const std::vector<std::optional<ComparedRun>> runs = {run("cubic as given", 0.3, true, "cubic", "as_given"),
                                                        run("log broken", 0.1, false),
                                                        std::nullopt,
                                                        run("log", 0.1),
                                                        run("log again", 0.1),
                                                        run("log as given", 0.2, true, "log", "as_given")};
  const std::vector<SweepMember> one_group(runs.size());
  EXPECT_EQ(default_reference(one_group, runs, 1), 3U);
  EXPECT_EQ(default_reference(one_group, runs, 4), 3U);
  EXPECT_EQ(default_reference(one_group, runs, 0), 5U);
  const std::vector<std::optional<ComparedRun>> one_valid = {run("log", 0.1, false), untouched("free"),
                                                             run("cubic", 0.4, true, "cubic")};
  EXPECT_EQ(default_reference(std::vector<SweepMember>(3), one_valid, 0), 2U);
  EXPECT_EQ(judge_comparability(*one_valid[2], one_valid[2]).verdict, "comparable");
  EXPECT_EQ(default_reference(std::vector<SweepMember>(1),
                              std::vector<std::optional<ComparedRun>>{run("log", 0.1, false)}, 0),
            std::nullopt);
}

TEST(Comparability, DefaultReferenceIsOfTheSameGroup) {
  const std::vector<std::optional<ComparedRun>> runs = {
      run("log fine", 0.1), run("cubic fine", 0.1, true, "cubic"), run("log coarse", 0.1),
      run("cubic coarse", 0.1, true, "cubic"), run("cubic alone", 0.1, true, "cubic")};
  const std::vector<SweepMember> members = {{"", {}, 0}, {"", {}, 0}, {"", {}, 1}, {"", {}, 1}, {"", {}, 2}};
  EXPECT_EQ(default_reference(members, runs, 1), 0U);
  EXPECT_EQ(default_reference(members, runs, 3), 2U);
  EXPECT_EQ(default_reference(members, runs, 4), 4U);
}

/// Which member a run is held against decides: here each other choice gives another verdict.
TEST(Comparability, DefaultReferenceIsTheFirstThatFitsAndNotTheLast) {
  const std::vector<std::optional<ComparedRun>> runs = {
      run("cubic first", 0.7, true, "cubic"), run("log", 0.1), run("log later", 0.5),
      run("quadratic", 0.15, true, "quadratic"), run("cubic last", 0.6, true, "cubic")};
  const std::vector<SweepMember> members(runs.size());
  const char* expected[] = {"not_comparable", "comparable", "not_comparable", "comparable", "not_comparable"};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto chosen = default_reference(members, runs, i);
    ASSERT_EQ(chosen, 1U) << i;
    EXPECT_EQ(judge_comparability(*runs[i], runs[*chosen]).verdict, expected[i]) << i;
  }
}

class ComparabilityFiles : public ::testing::Test {
 protected:
  void write(const char* name, double gap) const {
    RunRecord r;
    r.ids.run_id = std::string(64, 'a');
    r.labels.shape = "log";
    r.labels.argument = "gap";
    r.status.valid = r.validity.valid = true;
    r.summary.gap_min_rel = summarize({gap, 0.9});
    r.summary.contact_gaps["cloth|floor"] = gaps(gap);
    write_run(root_ / name, r);
  }
  json read(const char* name) const { return json::parse(std::ifstream(root_ / name / "run.json")); }
  test::TemporaryFolder root_;
};

TEST_F(ComparabilityFiles, EveryRecordOfASweepGetsItAndOneThatSaysSoIsLeftAlone) {
  write("log", 0.1), write("near", 0.15), write("far", 0.5);
  fs::create_directories(root_ / "torn");
  std::ofstream(root_ / "torn" / "run.json") << R"({"schema": )";
  const std::vector<SweepMember> members = {{root_ / "far", {}},
                                            {root_ / "torn", {}},
                                            {root_ / "absent", {}},
                                            {root_ / "log", {}},
                                            {root_ / "near", 3U}};
  const json before = read("near");
  write_comparability(members);

  EXPECT_EQ(read("far")["comparability"]["reference_run"], "far");  // the first: no mark
  EXPECT_EQ(read("log")["comparability"]["verdict"], "not_comparable");
  json after = read("near");
  EXPECT_EQ(after["comparability"]["reference_run"], "log");
  EXPECT_EQ(after["comparability"]["verdict"], "comparable");
  after["comparability"] = before["comparability"];
  EXPECT_EQ(after, before);  // nothing else of the record moved
  EXPECT_FALSE(fs::exists(root_ / "absent"));

  EXPECT_FALSE(fs::exists(root_ / "near" / "bench.lock"));

  const auto written = fs::last_write_time(root_ / "near" / "run.json");
  write_comparability(members);
  EXPECT_EQ(fs::last_write_time(root_ / "near" / "run.json"), written);
}

/// Every record of a sweep without a mark is held against the one run that the rule picks, whatever stands between.
TEST_F(ComparabilityFiles, AllRecordsAreHeldAgainstOneReference) {
  const std::pair<const char*, double> runs[] = {
      {"one", 0.1}, {"two", 0.19}, {"three", 0.37}, {"four", 0.06}};
  std::vector<SweepMember> members;
  for (const auto& [name, gap] : runs) {
    write(name, gap);
    members.push_back({root_ / name, {}});
  }
  write_comparability(members);
  const char* expected[] = {"comparable", "comparable", "not_comparable", "comparable"};
  for (std::size_t i = 0; i < 4; ++i) {
    const json found = read(runs[i].first)["comparability"];
    EXPECT_EQ(found["reference_run"], "one");
    EXPECT_EQ(found["verdict"], expected[i]) << i;
    EXPECT_DOUBLE_EQ(found["pair_ratio"], runs[i].second / 0.1);
  }
}

TEST_F(ComparabilityFiles, AMarkedReferenceThatLeftNoRecordIsNamed) {
  write("near", 0.15), write("refused", 0.1);
  write_comparability(std::vector<SweepMember>{{root_ / "near", 1U}, {root_ / "refused", {}, 0, false}});
  const json found = read("near")["comparability"];
  EXPECT_EQ(found["verdict"], "no_reference");
  EXPECT_EQ(found["reference_run"], "refused");
  EXPECT_EQ(found["reference_gap_rel_status"], "no_reference");  // a word of its field's list
  EXPECT_NE(found["reason"].get<std::string>().find("left no record"), std::string::npos) << found["reason"];
  EXPECT_EQ(read("refused")["comparability"]["reference_run"], "");  // of an earlier sweep: left alone
}

TEST_F(ComparabilityFiles, AFolderThatAnotherProcessHoldsIsNotWrittenTo) {
  write("log", 0.1);
  const std::vector<SweepMember> members = {{root_ / "log", {}}};
  const FolderLock held(root_ / "log");
  EXPECT_THROW(write_comparability(members), RecordError);
  EXPECT_EQ(read("log")["comparability"]["reference_run"], "");
}

}  // namespace
}  // namespace bb::comparability_test
