// Only regular files are opened, and no more of them is read than their kind allows.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "core/base/input/read_file.hpp"
#include "core/math/error.hpp"
#include "tests/temporary_folder.hpp"

namespace bb {
namespace {

class ReadFile : public ::testing::Test {
 protected:
  std::string at(const char* name) const { return (folder_ / name).string(); }

  test::TemporaryFolder folder_;
};

std::string fault_of(const std::string& path, const InputKind& kind) {
  try {
    read_input_file(path, kind);
  } catch (const ConfigError& error) {
    return error.violations().front().found;
  }
  return "";
}

constexpr InputKind ten{"a small file", 10};

TEST_F(ReadFile, ARegularFileIsReadWholeUpToItsLimit) {
  std::ofstream(at("nine")) << std::string("12345\0789", 9);
  std::ofstream(at("ten")) << "0123456789";
  std::ofstream(at("eleven")) << "0123456789a";
  EXPECT_EQ(read_input_file(at("nine"), ten), std::string("12345\0789", 9));
  EXPECT_EQ(read_input_file(at("ten"), ten), "0123456789");
  EXPECT_EQ(fault_of(at("eleven"), ten), "11 bytes");
  std::filesystem::create_symlink(at("ten"), at("link"));
  EXPECT_EQ(read_input_file(at("link"), ten), "0123456789");
}

TEST_F(ReadFile, AFileThatHidesItsSizeIsStillBounded) {  // 0 bytes by its own account
  EXPECT_FALSE(read_input_file("/proc/self/status", config_file).empty());
  EXPECT_EQ(fault_of("/proc/self/status", ten), "more than 10 bytes");
}

TEST_F(ReadFile, WhatIsNoRegularFileIsNamed) {
  ASSERT_EQ(::mkfifo(at("fifo").c_str(), 0600), 0);
  EXPECT_EQ(fault_of(at("fifo"), ten), "a FIFO");
  EXPECT_EQ(fault_of("/dev/zero", ten), "a character device");
  EXPECT_EQ(fault_of(folder_.path(), ten), "a folder");
  EXPECT_EQ(fault_of("", ten), "no path");
  EXPECT_EQ(fault_of(at("absent"), ten), "No such file or directory");
  EXPECT_EQ(fault_of(std::string("/dev/null\0a", 11), ten), "a path with a zero byte");
  EXPECT_THROW(require_regular_file(at("fifo"), ten), ConfigError);
}

}  // namespace
}  // namespace bb
