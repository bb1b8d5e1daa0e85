// The lists kernels.inc against the kernels that are really launched: a launch leaves the function that runs its kernel
// on the host in the object file, so that also launches which no test reaches are seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>
#include <string>

#include "core/exec/kernel_info.hpp"
#include "tests/executor/kernel_lists.hpp"

namespace {

using Names = std::set<std::string>;

/// "each bb::exec::X" or "blocks ...", without spaces in X, which compilers set differently.
std::string entry(const std::string& kind, std::string name) {
  std::erase(name, ' ');
  return kind + " " + name;
}

template <class F>
std::string name_of() {
  return bb::exec::KernelInfo{typeid(F), sizeof(F), false, nullptr}.name();
}

Names listed() {
  Names out;
#define EACH(...) out.insert(entry("each", name_of<__VA_ARGS__>()));
#define BLOCKS(...) out.insert(entry("blocks", name_of<__VA_ARGS__>()));
#include "tests/executor/kernel_lists.inc"
#undef EACH
#undef BLOCKS
  out.erase(entry("each", name_of<bb::exec::NoKernel>()));
  return out;
}

/// Kernels of families (core/energy/families, core/terms) that a host alone launches: local terms element by element, those in float, and those
/// of every vertex, which an executor takes in launches of their own (core/terms/executor/load_kernels.hpp).
bool of_host(const std::string& entry) {
  if (entry.starts_with("each bb::exec::")) return false;
  return entry.starts_with("each bb::ElementLocalTerms<") ||
         entry.starts_with("each bb::MotionLocalTerms<") || entry.ends_with(",float>") ||
         entry.find("<bb::InertiaOf<") != std::string::npos ||
         entry.find("<bb::WeightLoads") != std::string::npos;
}

/// The kernels of the functions bb::exec::detail::run_each<X> and run_blocks<X> in object files.
Names launched(const std::string& files) {
  Names out;
  FILE* symbols = popen(("nm -C --defined-only " + files).c_str(), "r");
  std::array<char, 4096> line;
  while (symbols && fgets(line.data(), line.size(), symbols)) {
    const std::string text = line.data();
    for (const std::string kind : {"each", "blocks"}) {
      const std::string start = "bb::exec::detail::run_" + kind + "<";
      const std::size_t begin = text.find(start), end = text.find(">(void const*");
      if (begin == std::string::npos || end == std::string::npos) continue;
      if (text.find("(anonymous namespace)") != std::string::npos) continue;  // a test's own
      const std::string found = entry(kind, text.substr(begin + start.size(), end - begin - start.size()));
      if (!of_host(found)) out.insert(found);
    }
  }
  EXPECT_TRUE(symbols && pclose(symbols) == 0) << "nm " << files;
  return out;
}

Names missing(const Names& from, const Names& of) {
  Names out;
  std::set_difference(of.begin(), of.end(), from.begin(), from.end(), std::inserter(out, out.end()));
  return out;
}

/// Launched, and in no list: its device code comes with each shape (core/contact/executor/given_shape.hpp).
const Names given = {entry("each", "bb::exec::EvaluateGivenShape")};

TEST(KernelLists, NameEveryKernelThatIsLaunched) {
  const Names of_modules = launched(BB_MODULE_FILES);
  EXPECT_GT(of_modules.size(), 100u);
  EXPECT_EQ(missing(listed(), of_modules), given);
  const Names of_tests = launched(BB_TEST_FILES);
  EXPECT_GT(of_tests.size(), 100u);
  EXPECT_EQ(missing(listed(), of_tests), given);
}

// What nothing launches costs the device compiler its time.
TEST(KernelLists, NameNothingElse) {
  Names all = launched(BB_MODULE_FILES);
  all.merge(launched(BB_TEST_FILES));
  EXPECT_EQ(missing(all, listed()), Names());
}

}  // namespace
