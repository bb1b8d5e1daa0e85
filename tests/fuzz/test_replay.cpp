// Every fuzz target on its seeds, on what fuzzing found once (found/TARGET/), and on seeds cut and changed by a fixed
// rule. Needs no clang; the same functions are fuzzed by ./bench dev fuzz.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include "tests/folders.hpp"
#include "tests/fuzz/seeds.hpp"
#include "tests/fuzz/target.hpp"

#define BB_FUZZ_TARGET(name) extern "C" int fuzz_##name(const std::uint8_t* data, std::size_t size);
#include "tests/fuzz/targets.inc"
#undef BB_FUZZ_TARGET

namespace bb::fuzz {
namespace {

using Target = int (*)(const std::uint8_t*, std::size_t);

const std::map<std::string, Target>& targets() {
#define BB_FUZZ_TARGET(name) {#name, fuzz_##name},
  static const std::map<std::string, Target> all{
#include "tests/fuzz/targets.inc"
  };
#undef BB_FUZZ_TARGET
  return all;
}

void feed(Target target, const std::string& bytes) {
  EXPECT_EQ(target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
}

class FuzzReplay : public testing::TestWithParam<std::string> {
 protected:
  Target target() const { return targets().at(GetParam()); }
};

TEST_P(FuzzReplay, SeedsAndWhatWasFoundAreSurvived) {
  const std::vector<std::string> seeds = seeds_of(GetParam());
  ASSERT_FALSE(seeds.empty());
  for (const std::string& seed : seeds) feed(target(), seed);
  std::error_code none_found;
  const auto folder = std::filesystem::path(BB_SOURCE_DIR) / "tests/fuzz/found" / GetParam();
  for (const auto& file : std::filesystem::directory_iterator(folder, none_found)) {
    SCOPED_TRACE(file.path().filename().string());
    std::ifstream in(file.path(), std::ios::binary);
    feed(target(), std::string(std::istreambuf_iterator<char>(in), {}));
  }
}

/// Cuts, a changed byte and a repeated piece: the faults that a broken disk or an editor makes.
TEST_P(FuzzReplay, BrokenSeedsAreRefused) {
  std::mt19937 random(5);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  int judged = 0;
  for (const std::string& seed : seeds_of(GetParam())) {
    for (int k = 0; k < 200; ++k) {
      std::string bytes = seed;
      if (k % 4 == 0) bytes.resize(below(bytes.size()));
      if (k % 4 == 1) bytes[below(bytes.size())] = static_cast<char>(below(256));
      if (k % 4 == 2) bytes[below(bytes.size())] = "0-9e\"[{,}\n"[below(10)];
      if (k % 4 == 3) bytes.insert(below(bytes.size()), bytes.substr(below(bytes.size()), below(30) + 1));
      feed(target(), bytes);
      ++judged;
    }
  }
  EXPECT_GE(judged, 200);
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzReplay, testing::ValuesIn(target_names()),
                         [](const auto& one) { return one.param; });

TEST(FuzzTargets, EveryTargetHasSeedsAndIsReplayed) {
  ASSERT_EQ(targets().size(), target_names().size());
  for (const std::string& name : target_names()) EXPECT_TRUE(targets().contains(name)) << name;
}

}  // namespace
}  // namespace bb::fuzz
