// The files of a checkpoint: what was written last is read, whatever a process that was killed left behind it.
#include "experiments/run/checkpoint.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/math/error.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::checkpoint_test {
namespace {

namespace fs = std::filesystem;

class CheckpointFiles : public ::testing::Test {
 protected:
  std::string bytes(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  test::TemporaryFolder folder_;
};

/// A state of some size and two lists, one of which has no item at every other step.
struct State {
  std::vector<double> fixed = std::vector<double>(100, 0.5), of_steps, sometimes;
  void step() {
    fixed[of_steps.size() % fixed.size()] += 1;
    if (of_steps.size() % 2 == 0) sometimes.push_back(-double(of_steps.size()));
    of_steps.push_back(double(of_steps.size()));
  }
  void keep(Archive& archive) {
    archive.scope("pass");
    archive.grown("steps", of_steps);
    archive(fixed);
    archive.grown("sometimes", sometimes);
  }
  bool operator==(const State&) const = default;
};

void save(Checkpoint& checkpoint, State& state, bool sync) {
  Archive archive = checkpoint.begin();
  archive(state);
  checkpoint.write(archive, {}, sync);
}

/// What its checkpoint holds.
State two_steps_of_a_process_that_is_over(const fs::path& folder) {
  State state;
  Checkpoint writer(folder, "program");
  state.step(), state.step();
  save(writer, state, true);
  return state;
}

State read(Checkpoint& checkpoint) {
  State out;
  std::optional<Archive> archive = checkpoint.read();
  if (!archive) return out;
  (*archive)(out);
  EXPECT_TRUE(archive->at_end());
  return out;
}

TEST_F(CheckpointFiles, TheLatestIsReadAndTheLogHoldsEachItemOnce) {
  State state;
  Checkpoint writer(folder_, "program");
  EXPECT_FALSE(writer.read());
  std::uintmax_t log = 0;
  for (int i = 0; i < 40; ++i) {
    state.step();
    save(writer, state, i % 7 == 0);
    const std::uintmax_t now = fs::file_size(folder_ / "checkpoint.log");
    EXPECT_LE(now - log, 150u) << i;  // two items and their names
    log = now;
    Checkpoint reader(folder_, "program");
    EXPECT_EQ(read(reader), state) << i;
  }
  EXPECT_GT(log, 40 * sizeof(double));
  EXPECT_EQ(fs::file_size(folder_ / "checkpoint.bin") / 10,
            fs::file_size(folder_ / "checkpoint.next.bin") / 10);
}

TEST_F(CheckpointFiles, OneThatGoesOnWritesWhatTheOtherWouldHave) {
  State whole, parts;
  fs::create_directories(folder_ / "parts"), fs::create_directories(folder_ / "whole");
  Checkpoint one(folder_ / "whole", "program");
  for (int process = 0; process < 5; ++process) {
    Checkpoint another(folder_ / "parts", "program");
    State resumed = read(another);
    EXPECT_EQ(resumed, parts);
    for (int i = 0; i < 3; ++i) {
      whole.step(), resumed.step();
      save(one, whole, i == 0), save(another, resumed, i == 0);
      parts = resumed;
    }
  }
  EXPECT_EQ(bytes("parts/checkpoint.log"), bytes("whole/checkpoint.log"));
  EXPECT_EQ(bytes("parts/checkpoint.next.bin"), bytes("whole/checkpoint.next.bin"));
}

TEST_F(CheckpointFiles, WhatWasCutOffIsNotReadAndTheOneBeforeIs) {
  State synced, next;
  {
    Checkpoint writer(folder_, "program");
    next.step(), next.step();
    save(writer, next, true);
    synced = next;
    next.step();
    save(writer, next, false);
  }
  const std::string whole = bytes("checkpoint.next.bin"), log = bytes("checkpoint.log");
  for (std::size_t n = 0; n <= whole.size();
       n += n + 37 < whole.size() ? 37 : 1) {  // what came later is of an older one
    put("checkpoint.next.bin",
        whole.substr(0, n) + (n < whole.size() ? std::string(whole.size() - n, 'x') : ""));
    Checkpoint reader(folder_, "program");
    EXPECT_EQ(read(reader), n == whole.size() ? next : synced) << n;
  }
  put("checkpoint.log",
      log + "half of an item");  // the process was killed before the checkpoint that it is of
  Checkpoint reader(folder_, "program");
  State resumed = read(reader);
  EXPECT_EQ(resumed, next);
  resumed.step();
  save(reader, resumed, true);
  Checkpoint after(folder_, "program");
  EXPECT_EQ(read(after), resumed);
}

TEST_F(CheckpointFiles, DamageIsRefusedAndNamed) {
  two_steps_of_a_process_that_is_over(folder_);
  const auto refused = [&](const std::string& file) {
    Checkpoint reader(folder_, "program");
    try {
      reader.read();
      ADD_FAILURE() << file << " is read";
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
    }
  };
  for (const std::string file : {"checkpoint.bin", "checkpoint.log"}) {
    const std::string good = bytes(file);
    ASSERT_GT(good.size(), 10u);
    for (std::size_t i = 0; i < good.size(); i += 11) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ 1);
      put(file, bad);
      refused(file);
    }
    put(file, good.substr(0, good.size() - 1));
    refused(file);
    put(file, good);
  }
  fs::remove(folder_ / "checkpoint.log");
  refused("checkpoint.log");
  Checkpoint other(folder_, "another program");
  EXPECT_THROW(other.read(), ConfigError);
}

TEST_F(CheckpointFiles, WhatIsForgottenIsInNoLaterOne) {
  State state;
  const State earlier = two_steps_of_a_process_that_is_over(folder_);
  Checkpoint another(folder_, "program");
  EXPECT_EQ(read(another), earlier);
  another.forget();
  state.step();
  save(another, state, true);
  Checkpoint reader(folder_, "program");
  EXPECT_EQ(read(reader), state);
}

TEST_F(CheckpointFiles, AListThatBecameShorterIsAnError) {
  State state;
  Checkpoint writer(folder_, "program");
  state.step(), state.step();
  save(writer, state, true);
  state.of_steps.pop_back();
  Archive archive = writer.begin();
  EXPECT_THROW(archive(state), std::logic_error);
  state.of_steps.clear();  // one that is not there
  Archive without = writer.begin();
  EXPECT_NO_THROW(without(state));
}

}  // namespace
}  // namespace bb::checkpoint_test
