// Writing records: all or nothing, named failures, no non-finite number without a reason.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"
#include "tests/folders.hpp"
#include "tests/record/sample_record.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::writer_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Writer : public ::testing::Test {
 protected:
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  json read(const std::string& name) const { return json::parse(std::ifstream(folder_ / name)); }
  test::TemporaryFolder folder_;
};

/// No file of this process may grow beyond `bytes`: a disk that is full, for everyone who writes.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

template <class Action>
std::string failure_of(Action action) {
  try {
    action();
  } catch (const RecordError& e) {
    return e.what();
  }
  return {};
}

TEST_F(Writer, WritesIntoAFolderThatIsNotThere) {
  const RunRecord record = test::sample_record();
  write_run(folder_ / "a" / "b", record);
  const json j = read("a/b/run.json");
  EXPECT_EQ(j["schema"]["version"], run_schema_version);
  EXPECT_EQ(j["status"]["outcome"], "newton_stall");
  EXPECT_EQ(j["config"], json::parse(record.config.text));
  EXPECT_EQ(j["ids"]["sweep_id"], "strip");
  EXPECT_FALSE(j["ids"].contains("rerun_of"));
  EXPECT_EQ(j["steps"][0]["time"], json({{"linear_factor_s", 0.5}}));
  EXPECT_EQ(j["summary"]["cond"]["full/block_jacobi"]["statuses"]["ok"], 2);
}

TEST_F(Writer, ReplacesAnOldRecordAsAWhole) {
  RunRecord record = test::sample_record();
  write_run(folder_, record);
  record.status.detail = "second";
  write_run(folder_, record);
  EXPECT_EQ(read("run.json")["status"]["detail"], "second");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Writer, OfTwoThatWantToBeTheFirstOneIs) {
  const fs::path file = folder_ / "one.json";
  {
    StagedFile first(file, "[1]"), second(folder_ / "two.json", "[2]");
    EXPECT_TRUE(first.commit_as_first());
    EXPECT_TRUE(second.commit_as_first());
  }
  {
    StagedFile late(file, "[3]");
    EXPECT_FALSE(late.commit_as_first());
    EXPECT_EQ(read("one.json"), json({1}));
  }
  EXPECT_EQ(entries(), 2u);
  StagedFile(file, "[4]").commit();
  EXPECT_EQ(read("one.json"), json({4}));
  EXPECT_EQ(read("two.json"), json({2}));
}

TEST_F(Writer, NonFiniteNumbersAreNullWithAReason) {
  RunRecord record = test::sample_record();
  record.steps[0].alpha_ccd_min = std::numeric_limits<double>::infinity();
  record.steps[0].elastic_J = -std::numeric_limits<double>::infinity();
  record.summary.wall_s = std::nan("");
  const json j = json::parse(to_json(record));
  EXPECT_TRUE(j["steps"][0]["gap_min_m"].is_null());
  EXPECT_EQ(j["steps"][0]["gap_min_m_status"], "not_converged");
  EXPECT_EQ(j["steps"][0]["alpha_ccd_min_status"], "infinite");
  EXPECT_EQ(j["steps"][0]["elastic_J_status"], "minus_infinite");
  EXPECT_EQ(j["summary"]["wall_s_status"], "nan");
  EXPECT_FALSE(j["steps"][0].contains("gap_min_iterates_m_status"));
}

TEST_F(Writer, ANumberThatIsNotFiniteWhereNoReasonFitsIsRefused) {
  for (const double value : {std::nan(""), -std::numeric_limits<double>::infinity()}) {
    RunRecord record = test::sample_record();
    record.machine.load_avg[1] = value;
    EXPECT_THROW(to_json(record), std::logic_error);
  }
}

TEST_F(Writer, ATraceLineNamesUnknownEigenvaluesAndCountsAllContacts) {
  const json j = json::parse(to_json(test::sample_trace_row()));
  EXPECT_TRUE(j["cond"][0]["cond"].is_null());
  EXPECT_EQ(j["cond"][0]["cond_status"], "lower_bound");
  EXPECT_EQ(j["max_stretch_status"], "not_measured");
  EXPECT_EQ(j["contacts"]["total"], 2);
}

TEST_F(Writer, AFullDiskIsNamedAndLeavesNothing) {
  const RunRecord record = test::sample_record();
  std::string error;
  {
    const FullDisk limit(100);
    error = failure_of([&] { write_run(folder_, record); });
  }
  EXPECT_NE(error.find("run.json"), std::string::npos) << error;
  EXPECT_NE(error.find("File too large"), std::string::npos) << error;
  EXPECT_EQ(entries(), 0u);

  write_run(folder_, record);
  const std::string before = read("run.json").dump();
  {
    const FullDisk limit(100);
    EXPECT_NE(failure_of([&] { write_run(folder_, record); }), "");
  }
  EXPECT_EQ(read("run.json").dump(), before);
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Writer, CheckWritableFailsBeforeTheRun) {
  const FullDisk limit(100);
  EXPECT_NE(failure_of([&] { check_writable(folder_); }), "");
  EXPECT_EQ(entries(), 0u);
}

TEST_F(Writer, AFolderThatCannotBeWrittenIsNamed) {
  if (::geteuid() != 0) {
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_NE(failure_of([&] { write_run(folder_, test::sample_record()); }).find("Permission denied"),
              std::string::npos);
  }
  const std::string below_a_file = failure_of([&] { write_run("/dev/null/runs", test::sample_record()); });
  EXPECT_NE(below_a_file.find("/dev/null/runs: cannot create the folder"), std::string::npos) << below_a_file;
  const std::string kernel = failure_of([&] { write_run("/proc/bb_runs", test::sample_record()); });
  EXPECT_NE(kernel.find("/proc/bb_runs"), std::string::npos) << kernel;
  EXPECT_NE(failure_of([&] { check_writable("/proc/bb_runs"); }), "");
}

TEST_F(Writer, TraceIsOnDiskAfterEachStep) {
  TraceWriter trace(folder_);
  trace.add(test::sample_trace_row());
  trace.end_step();
  EXPECT_FALSE(fs::exists(folder_ / "trace.jsonl"));
  EXPECT_GT(fs::file_size(folder_ / "trace.jsonl.part"), 0U);  // a step is with the system at its end
  trace.finish();
  EXPECT_FALSE(fs::exists(folder_ / "trace.jsonl.part"));
  std::ifstream in(folder_ / "trace.jsonl");
  std::string line;
  ASSERT_TRUE(std::getline(in, line));
  EXPECT_EQ(json::parse(line)["step"], 3);
}

TEST_F(Writer, TheRecordCanNameTheTraceAsItWillBe) {
  TraceWriter trace(folder_);
  trace.add(test::sample_trace_row());
  trace.end_step();
  trace.add(test::sample_trace_row());  // not handed on yet
  const Artifact named = trace.artifact();
  trace.finish();
  EXPECT_EQ(named.path, "trace.jsonl");
  EXPECT_EQ(named.kind, "trace");
  EXPECT_EQ(named.bytes, fs::file_size(folder_ / "trace.jsonl"));
  EXPECT_EQ(named.sha256, sha256_file((folder_ / "trace.jsonl").string()));
  EXPECT_EQ(named.sha256.size(), 64U);
}

TEST_F(Writer, ATraceThatIsNotFinishedLeavesTheEarlierOne) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "trace.jsonl") << "earlier\n";
  {
    TraceWriter trace(folder_);
    trace.add(test::sample_trace_row());
    trace.end_step();
  }
  std::ifstream in(folder_ / "trace.jsonl");
  std::string line;
  ASSERT_TRUE(std::getline(in, line));
  EXPECT_EQ(line, "earlier");
  EXPECT_FALSE(fs::exists(folder_ / "trace.jsonl.part"));
}

TEST_F(Writer, ATraceOnAFullDiskIsNamed) {
  TraceWriter trace(folder_);
  std::string error;
  {
    const FullDisk limit(10);
    error = failure_of([&] {
      trace.add(test::sample_trace_row());
      trace.end_step();
    });
  }
  EXPECT_NE(error.find("trace.jsonl: cannot write"), std::string::npos) << error;
}

TEST_F(Writer, AConfigThatIsNotJsonIsRefused) {
  RunRecord record = test::sample_record();
  record.config.text = "{";
  EXPECT_THROW(to_json(record), std::invalid_argument);
}

}  // namespace
}  // namespace bb::writer_test
