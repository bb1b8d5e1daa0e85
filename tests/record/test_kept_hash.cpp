// A hash is read back for the very same file only.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "core/base/record/kept_hash.hpp"
#include "core/base/record/provenance.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::kept_hash_test {
namespace {

namespace fs = std::filesystem;

class KeptHash : public ::testing::Test {
 protected:
  KeptHash() { write("abc"); }

  void write(const std::string& text) const { std::ofstream(file_) << text; }
  std::size_t kept() const {
    std::error_code none;
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_, none), {}));
  }
  /// What stands in every file of the folder.
  void overwrite(const std::string& text) const {
    for (const auto& entry : fs::directory_iterator(folder_)) std::ofstream(entry.path()) << text;
  }

  test::TemporaryFolder root_;
  fs::path folder_ = root_ / "hashes";
  std::string file_ = root_ / "program";
};

TEST_F(KeptHash, IsThatOfTheFileAndIsReadTheNextTime) {
  EXPECT_EQ(kept_sha256(file_, folder_, 0), sha256_hex("abc"));
  ASSERT_EQ(kept(), 1u);
  EXPECT_EQ(kept_sha256(file_, folder_, 0), sha256_hex("abc"));
  const std::string another(64, 'a');
  overwrite(another + "\n");
  EXPECT_EQ(kept_sha256(file_, folder_, 0), another);
}

TEST_F(KeptHash, AFileOfOtherContentOrAnotherInodeIsHashedAgain) {
  kept_sha256(file_, folder_, 0);
  overwrite(std::string(64, 'a') + "\n");
  write("abd");  // of the same size
  EXPECT_EQ(kept_sha256(file_, folder_, 0), sha256_hex("abd"));
  overwrite(std::string(64, 'a') + "\n");
  fs::rename(file_, file_ + ".old");
  write("abd");
  EXPECT_EQ(kept_sha256(file_, folder_, 0), sha256_hex("abd"));
  EXPECT_EQ(kept(), 3u);
}

TEST_F(KeptHash, WhatHasJustChangedIsNotKept) {
  EXPECT_EQ(kept_sha256(file_, folder_, 3600), sha256_hex("abc"));
  EXPECT_EQ(kept(), 0u);
}

TEST_F(KeptHash, WhatIsNoHashIsMadeAnew) {
  kept_sha256(file_, folder_, 0);
  for (const std::string& text : {std::string(), std::string("abc\n"), std::string(64, 'g')}) {
    overwrite(text);
    EXPECT_EQ(kept_sha256(file_, folder_, 0), sha256_hex("abc")) << text;
  }
  EXPECT_EQ(kept_sha256(file_, folder_, 0), sha256_hex("abc"));
}

TEST_F(KeptHash, AFolderThatCannotBeMadeKeepsNothing) {
  write("abc");
  EXPECT_EQ(kept_sha256(file_, fs::path(file_) / "below_a_file", 0), sha256_hex("abc"));
  EXPECT_EQ(kept_sha256(file_, {}, 0), sha256_hex("abc"));
  EXPECT_EQ(kept_sha256(root_ / "nothing", folder_, 0), "");
  EXPECT_EQ(kept_sha256(root_.path(), folder_, 0), "");
  EXPECT_EQ(kept(), 0u);
}

}  // namespace
}  // namespace bb::kept_hash_test
