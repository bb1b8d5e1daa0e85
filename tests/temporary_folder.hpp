// The one place where tests of C++ make temporary files.
#pragma once

#include <gtest/gtest.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace bb::test {

/// A new empty folder with a name of its own. It is removed with all that it holds when this object ends, also where a test failed.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "barrierbench_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw std::filesystem::filesystem_error("cannot make a temporary folder", name,
                                              {errno, std::generic_category()});
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    give_rights_back();
    std::error_code error;
    std::filesystem::remove_all(path_, error);
    EXPECT_FALSE(error) << path_ << " is left: " << error.message();
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  operator const std::filesystem::path&() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& below) const { return path_ / below; }

 private:
  /// A test may have taken the rights of this folder, or of a folder in it; what is in such a folder could not be removed.
  void give_rights_back() const {
    namespace fs = std::filesystem;
    std::error_code error;
    fs::permissions(path_, fs::perms::owner_all, error);
    // The rights of a folder are given back before the iterator goes into it.
    for (fs::recursive_directory_iterator at(path_, error), end; !error && at != end; at.increment(error)) {
      if (at->symlink_status(error).type() == fs::file_type::directory) {
        fs::permissions(at->path(), fs::perms::owner_all, error);
      }
    }
  }

  std::filesystem::path path_;
};

}  // namespace bb::test
