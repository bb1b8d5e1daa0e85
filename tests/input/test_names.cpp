// Names that become folders, and the memory that a scene may request.
#include <gtest/gtest.h>

#include "core/base/input/memory.hpp"
#include "core/base/input/names.hpp"

namespace bb {
namespace {

bool is_plain(const std::string& name) {
  std::vector<Violation> violations;
  const bool plain = check_plain_name("a.json#/name", name, violations);
  EXPECT_EQ(violations.empty(), plain);
  return plain;
}

TEST(Names, PlainOnesAreAcceptedOthersAreNot) {
  for (const char* good :
       {"a", "cubic_dynamic x s", "log, equal force", "dt_s=0.01", "\xc3\xa9t\xc3\xa9", "a.b"}) {
    EXPECT_TRUE(is_plain(good)) << good;
  }
  for (const char* bad : {"", ".", "..", ".a", "a/b", "/a", "a\\b", "a..b", "../a", "a\nb", "a\x7f"}) {
    EXPECT_FALSE(is_plain(bad)) << bad;
  }
  EXPECT_FALSE(is_plain(std::string("a\0b", 3)));
  EXPECT_TRUE(is_plain(std::string(max_name_bytes, 'a')));
  EXPECT_FALSE(is_plain(std::string(max_name_bytes + 1, 'a')));
}

TEST(Names, ControlCharactersAreShownAsText) {
  EXPECT_EQ(printable("a\x1b[31mb\x07"), "a\\x1b[31mb\\x07");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\r\x7f"), "\\x0d\\x7f");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // half of a pair
  EXPECT_EQ(printable("\xe0\x80\x80"), "\\xe0\\x80\\x80");           // longer than it has to be
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
  EXPECT_EQ(printable("\xf4\x8f\xbf\xbf"), "\xf4\x8f\xbf\xbf");
  EXPECT_EQ(printable("\xc2\x9b"
                      "1m"),
            "\\x9b1m");
  EXPECT_EQ(printable("\x9b"
                      "1m\xff"),
            "\\x9b1m\\xff");                       // no UTF-8
  EXPECT_EQ(printable("\xe4\xb8"), "\\xe4\\xb8");  // cut off
  for (const char* shown : {"", "a b\n\tc", "\xc3\xa9", "\xe4\xb8\xad", "\xf0\x9f\x98\x80", "\xc2\xa0"}) {
    EXPECT_EQ(printable(shown), shown);
  }
  EXPECT_TRUE(has_control_character("a\n"));
  EXPECT_FALSE(has_control_character("\xc3\xa9"));
}

TEST(Names, Utf8IsTold) {
  EXPECT_TRUE(is_utf8("\xc3\xa9"));
  EXPECT_FALSE(is_utf8("\xff"));
  EXPECT_FALSE(is_utf8("\xc3"));
}

TEST(Memory, ASceneThatCannotFitIsRefusedWithItsEstimate) {
  EXPECT_GT(memory_bytes(), std::uint64_t{1} << 28);
  EXPECT_NO_THROW(require_memory("a", surface_memory(1e5, 2e5)));
  EXPECT_GT(scene_bytes(surface_memory(1e5, 2e5)), 1e5 * 3 * 8);
  try {
    require_memory("a", surface_memory(4e12, 8e12));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_NE(error.violations().front().found.find("GiB"), std::string::npos);
    EXPECT_NE(error.violations().front().allowed.find("GiB"), std::string::npos);
  }
}

}  // namespace
}  // namespace bb
