// What the record reports of a run whose first or second pass was cut off: the states of the two passes are compared only
// where both went to the end.
#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <optional>

#include "experiments/config/parse.hpp"
#include "experiments/run/runner.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::cut_passes_test {
namespace {

constexpr const char* falling_sheet = R"({"schema": "barrierbench.config/1",
  "scene": {"bodies": [{"name": "cloth", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2},
                        "transform": {"translate_m": [0, 0, 0.012]}, "limited": false}],
            "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
  "formulation": {"name": "cubic", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 5000}},
  "matching": {"rule": "as_given"}, "passes": {"time": true, "audit": true}, "time": {"dt_s": 0.01, "steps": 6}})";

/// A run whose pass of this name finds no memory after `steps` of its steps.
RunRecord cut_in(const std::string& pass, int steps) {
  RunOptions options;
  const test::TemporaryFolder folder;
  options.folder = folder;
  options.progress = [&](const Progress& progress) {
    if (pass == progress.pass && progress.step == steps) throw std::bad_alloc();
  };
  return run_config(parse_config(falling_sheet, "test", ".", {}), options);
}

std::optional<bool> check(const RunRecord& record, const std::string& name) {
  for (const Check& one : record.validity.checks) {
    if (one.name == name) return one.pass;
  }
  return std::nullopt;
}

TEST(CutPasses, BothWholePassesEndInOneState) {
  const RunRecord record = cut_in("neither", 1);
  ASSERT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
  EXPECT_EQ(check(record, "state_hash_equal_in_all_passes"), true);
  EXPECT_EQ(record.steps.size(), 6U);
  EXPECT_GT(record.steps.back().contacts.total(), 0U);
  EXPECT_TRUE(record.status.valid);
}

/// A pass that was cut off ends in another state: that shows nothing about the other one.
TEST(CutPasses, APassThatWasCutOffIsComparedWithNothing) {
  for (const int steps : {2, 5}) {
    const RunRecord second = cut_in("diagnose", steps);
    EXPECT_EQ(second.status.outcome, Outcome::oom);
    EXPECT_NE(second.status.detail.find("pass diagnose"), std::string::npos) << second.status.detail;
    EXPECT_EQ(check(second, "state_hash_equal_in_all_passes"), std::nullopt);
    EXPECT_EQ(check(second, "outcome_ok"), false);  // which is what it fails by
    EXPECT_EQ(check(second, "audit_clean"), true);  // of what was judged
    EXPECT_EQ(second.steps.size(), static_cast<std::size_t>(steps));
    EXPECT_FALSE(second.status.valid);

    const RunRecord first = cut_in("time", steps);
    EXPECT_EQ(first.status.outcome, Outcome::oom);
    EXPECT_NE(first.status.detail.find("`diagnose` and `audit` were not run"), std::string::npos)
        << first.status.detail;
    EXPECT_EQ(check(first, "state_hash_equal_in_all_passes"), std::nullopt);
    EXPECT_EQ(check(first, "audit_clean"), std::nullopt);
    EXPECT_EQ(first.steps.size(), static_cast<std::size_t>(steps));
    EXPECT_FALSE(first.status.valid);
  }
}

}  // namespace
}  // namespace bb::cut_passes_test
