// The report on disk: made once, read again, and never believed when it is another build's or damaged.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"
#include "experiments/validity/stored_block.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::stored_block_test {
namespace {

class StoredBlocks : public ::testing::Test {
 protected:
  test::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_ / "validity";
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(StoredBlocks, the_second_time_the_report_is_read) {
  const StoredBlock made = block_of_this_build(folder_, {});
  EXPECT_TRUE(made.kept);
  EXPECT_TRUE(made.validity.valid) << made.validity.failed;
  EXPECT_EQ(made.validity.report_sha256, sha256_hex(text_of(made.file)));
  nlohmann::json report = nlohmann::json::parse(text_of(made.file));
  report["checks"][2]["value"] = 1e9;  // to see that it is read, and judged by its numbers
  write_atomically(made.file, report.dump(1));
  const StoredBlock read = block_of_this_build(folder_, {});
  EXPECT_FALSE(read.validity.valid);
  EXPECT_EQ(read.validity.failed, report["checks"][2]["name"].get<std::string>());
  EXPECT_EQ(read.validity.checks, made.validity.checks);
}

TEST_F(StoredBlocks, a_report_that_is_damaged_or_of_another_build_is_made_anew) {
  int n_computed = 0;
  const std::vector<BlockCheck> checks = compute_block();
  const auto compute = [&] {
    ++n_computed;
    return checks;
  };
  const StoredBlock made = block_of_this_build(folder_, {}, compute);
  EXPECT_EQ(n_computed, 1);
  nlohmann::json other = nlohmann::json::parse(made.report);
  other["build"] = "another";
  nlohmann::json empty = nlohmann::json::parse(made.report), short_one = empty, wrong_type = empty,
                 nameless = empty;
  empty.erase("checks");
  short_one["checks"].erase(3);
  wrong_type["checks"][0]["value"] = "small";
  nameless["checks"] = nlohmann::json::parse(R"([{"pass": true}])");
  nlohmann::json none = nlohmann::json::parse(made.report);
  none["checks"] = nlohmann::json::array();
  for (const std::string& text :
       {std::string(), made.report.substr(0, 200), other.dump(), empty.dump(), std::string("[]"),
        short_one.dump(), wrong_type.dump(), nameless.dump(), none.dump(), std::string(R"({"schema": 3})"),
        std::string(R"({"checks": [1]})")}) {
    write_atomically(made.file, text);
    n_computed = 0;
    const StoredBlock again = block_of_this_build(folder_, {}, compute);
    EXPECT_EQ(n_computed, 1);
    EXPECT_TRUE(again.validity.valid) << text.substr(0, 60);
    EXPECT_EQ(again.validity.checks, made.validity.checks);
    EXPECT_NE(text_of(made.file), text);
  }
}

TEST_F(StoredBlocks, of_two_processes_that_compute_it_at_once_both_have_the_report_of_the_first) {
  std::vector<BlockCheck> checks = compute_block();
  StoredBlock first;
  const StoredBlock second = block_of_this_build(folder_, {}, [&] {
    first = block_of_this_build(folder_, {}, [&] { return checks; });
    checks[0].detail = "of the second";
    return checks;
  });
  EXPECT_TRUE(first.kept && second.kept);
  EXPECT_EQ(second.report, first.report);
  EXPECT_EQ(second.validity.report_sha256, first.validity.report_sha256);
  EXPECT_EQ(text_of(first.file), first.report);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1)
      << "nothing is left beside it";
}

TEST(StoredBlock, a_report_without_a_check_is_not_valid) { EXPECT_FALSE(summary_of({}, "").valid); }

TEST_F(StoredBlocks, where_nothing_can_be_written_the_block_is_computed_all_the_same) {
  std::ofstream(folder_) << "a file in the place of the folder";
  const StoredBlock block = block_of_this_build(folder_, {});
  EXPECT_FALSE(block.kept);
  EXPECT_TRUE(block.validity.valid);
}

TEST_F(StoredBlocks, a_plugin_has_a_report_of_its_own) {
  PluginFile plugin;
  plugin.sha256 = std::string(64, 'a');
  EXPECT_NE(this_build({plugin}).sha256, this_build({}).sha256);
}

}  // namespace
}  // namespace bb::stored_block_test
