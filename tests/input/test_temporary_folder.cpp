// The folder in which tests make their files.
#include "tests/temporary_folder.hpp"

#include <unistd.h>

#include <fstream>
#include <stdexcept>

namespace bb::temporary_folder_test {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryFolder, goes_with_all_that_it_holds) {
  fs::path first, second;
  {
    const test::TemporaryFolder one, another;
    first = one, second = another;
    EXPECT_NE(first, second);
    EXPECT_TRUE(fs::is_empty(one));
    EXPECT_EQ(one.path().parent_path(), another.path().parent_path());
    fs::create_directories(one / "a/b");
    std::ofstream(one / "a/b/file") << "text";
  }
  EXPECT_FALSE(fs::exists(first));
  EXPECT_FALSE(fs::exists(second));
}

TEST(TemporaryFolder, goes_where_a_test_has_taken_rights) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "rights do not bind root";
  }
  fs::path left;
  {
    const test::TemporaryFolder folder;
    left = folder;
    fs::create_directories(folder / "a/b");
    std::ofstream(folder / "a/b/file") << "text";
    fs::permissions(folder / "a/b", fs::perms::none);
    fs::permissions(folder / "a", fs::perms::none);
    fs::permissions(folder, fs::perms::none);
  }
  EXPECT_FALSE(fs::exists(left));
}

TEST(TemporaryFolder, goes_where_a_test_ends_early) {
  fs::path left;
  const auto ends_early = [&left] {
    const test::TemporaryFolder folder;
    left = folder;
    std::ofstream(folder / "file") << "text";
    throw std::runtime_error("a test that fails");
  };
  EXPECT_THROW(ends_early(), std::runtime_error);
  ASSERT_FALSE(left.empty());
  EXPECT_FALSE(fs::exists(left));
}

}  // namespace
}  // namespace bb::temporary_folder_test
