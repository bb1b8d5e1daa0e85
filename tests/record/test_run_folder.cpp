// Locks of folders, and what goes when an earlier run gives way: names and contents that a run wrote.
#include "core/base/record/run_folder.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/record/folder_lock.hpp"
#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::run_folder_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class RunFolder : public ::testing::Test {
 protected:
  RunFolder() { fs::create_directory(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// A record that names each file with the hash of its present content.
  void write_record(const std::vector<std::string>& names) const {
    json record = {{"artifacts", json::array()}};
    for (const std::string& name : names) {
      record["artifacts"].push_back({{"path", name}, {"sha256", sha256_file((folder_ / name).string())}});
    }
    write("run.json", record.dump());
  }
  test::TemporaryFolder temporary_;
  fs::path folder_ = temporary_ / "run";
};

TEST_F(RunFolder, AnEarlierRunGoesWithWhatItWrote) {
  const fs::path frame = write("frames/step_000001.ply", "a"),
                 matrix = write("matrices/step_000001_iteration_002.mtx", "b");
  write_record({"frames/step_000001.ply", "matrices/step_000001_iteration_002.mtx"});
  write("trace.jsonl", "{}");
  remove_earlier_run(folder_);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(RunFolder, FilesOfOthersStay) {
  const std::string beside = "../outside.ply";
  const fs::path outside = write(beside, "o");
  const std::vector<std::string> others = {"frames/holiday.ply", "notes.txt", "frames/step_1.ply",
                                           "inputs/a.ply"};
  for (const std::string& name : others) write(name, "of somebody");
  write("frames/step_000001.ply", "as written");
  std::vector<std::string> named = others;
  named.insert(named.end(), {"frames/step_000001.ply", beside, outside.string()});
  write_record(named);
  write("frames/step_000001.ply", "changed since");
  write("frames/step_000002.ply", "in no record");
  remove_earlier_run(folder_);
  for (const std::string& name : others) EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  EXPECT_TRUE(fs::exists(folder_ / "frames/step_000001.ply"));
  EXPECT_TRUE(fs::exists(folder_ / "frames/step_000002.ply"));
  EXPECT_TRUE(fs::exists(outside));
  EXPECT_FALSE(fs::exists(folder_ / "run.json"));
}

TEST_F(RunFolder, ARecordThatSaysNothingUsefulIsNoFailure) {
  for (const char* text : {"", "{", "[]", "7", R"({"artifacts": 3})", R"({"artifacts": [1, {"path": 2}]})"}) {
    write("run.json", text);
    remove_earlier_run(folder_);
    EXPECT_TRUE(fs::is_empty(folder_)) << text;
  }
}

TEST_F(RunFolder, PartsOfAKilledRunGo) {
  EXPECT_EQ(part_of("frames/step_000001.ply"), fs::path("frames.part/step_000001.ply"));
  for (const char* ours :
       {"frames.part/step_000001.ply", "frames.part/step_000002.ply.tmp.77", "run.json.tmp.77",
        "trace.jsonl.part", "matrices.part/step_000001_iteration_000.mtx"}) {
    write(ours, "x");
  }
  const fs::path theirs[] = {write("run.json", "{}"), write("mine.tmp.77", "x"),
                             write("frames.part/mine.ply", "x")};
  remove_unfinished(folder_);
  for (const fs::path& file : theirs) EXPECT_TRUE(fs::exists(file)) << file;
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder_), {}), 4);
}

TEST_F(RunFolder, TheLockNamesItsHolderAndGoesWithIt) {
  {
    const FolderLock lock(folder_ / "made");
    try {
      const FolderLock second(folder_ / "made");
      ADD_FAILURE() << "two have the folder";
    } catch (const RecordError& error) {
      EXPECT_FALSE(error.lasting);
      EXPECT_NE(std::string(error.what()).find("process " + std::to_string(::getpid())), std::string::npos)
          << error.what();
    }
    const FolderLock other(folder_ / "other");
  }
  EXPECT_FALSE(fs::exists(folder_ / "made"));  // the lock made it, and nothing was written there
  const FolderLock again(folder_ / "made");
}

TEST_F(RunFolder, AFolderThatWasThereOrIsNotEmptyOutlivesItsLock) {
  fs::create_directory(folder_ / "there");
  { const FolderLock lock(folder_ / "there"); }
  EXPECT_TRUE(fs::is_empty(folder_ / "there"));
  {
    const FolderLock lock(folder_ / "made");
    std::ofstream(folder_ / "made" / "run.json") << "{}";
  }
  EXPECT_TRUE(fs::exists(folder_ / "made" / "run.json"));
  EXPECT_FALSE(fs::exists(folder_ / "made" / "bench.lock"));
}

/// A process takes the lock and ends without giving it back.
void leave_a_dead_lock(const fs::path& folder) {
  const ::pid_t child = ::fork();
  if (child == 0) {
    const FolderLock lock(folder);
    ::_exit(0);  // no destructor
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(fs::exists(folder / "bench.lock"));
}

TEST_F(RunFolder, TheLockOfAKilledProcessIsFree) {
  leave_a_dead_lock(folder_);
  const FolderLock lock(folder_);
}

TEST_F(RunFolder, ADeadLockIsRemovedAndALivingOneStays) {
  leave_a_dead_lock(folder_);
  remove_dead_lock(folder_);
  EXPECT_FALSE(fs::exists(folder_ / "bench.lock"));
  remove_dead_lock(folder_);
  const FolderLock lock(folder_);
  remove_dead_lock(folder_);
  EXPECT_TRUE(fs::exists(folder_ / "bench.lock"));
}

}  // namespace
}  // namespace bb::run_folder_test
