// Look-up by name, the text for a wrong name, and names that are taken.
#include "core/base/parameters/registry.hpp"

#include <gtest/gtest.h>

#include "core/base/parameters/parameter.hpp"

namespace bb {
namespace {

struct Thing {
  std::string name, doc;
  std::vector<Parameter> parameters;
};

Registry<Thing> things() {
  const Parameter shared{"refresh", flag(), true, "when"};
  return Registry<Thing>({named(Thing{"", "", {shared}}, "log", "one"),
                          named(Thing{"", "", {{"gap", flag(), false, "that"}, shared}}, "cubic", "other")});
}

std::string message(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Registry, FindsRequiresAndRefuses) {
  Registry<Thing> all = things();
  EXPECT_EQ(all.names(), (std::vector<std::string>{"log", "cubic"}));
  EXPECT_EQ(all.require("cubic", "here").doc, "other");
  EXPECT_EQ(all.find("cubik"), nullptr);
  EXPECT_EQ(message([&] { all.require("cubik", "a.json#/shape"); }),
            "a.json#/shape: found \"cubik\"; allowed: one of log, cubic (did you mean cubic?)");
  EXPECT_EQ(message([&] { all.require("zzzzzz", "here"); }),
            "here: found \"zzzzzz\"; allowed: one of log, cubic");
  EXPECT_EQ(message([&] {
              all.add({"log", "", {}}, "my.so");
            }),
            "my.so: found \"log\"; allowed: a name that is not yet taken");
  all.add({"new", "", {}}, "my.so");
  EXPECT_EQ(all.size(), 3u);
}

TEST(Registry, RowsOfAllAreThereOnceWithTheEntriesThatReadThem) {
  const std::vector<Parameter> rows = rows_of_all(things());
  ASSERT_EQ(names_of(rows), (std::vector<std::string>{"refresh", "gap"}));
  EXPECT_EQ(rows[0].doc, "cubic, log: when");
  EXPECT_EQ(rows[1].doc, "cubic: that");
}

TEST(NearestName, CountsEdits) {
  EXPECT_EQ(nearest_name("lgo", {"log", "cubic"}), "");  // two edits of three letters are no resemblance
  EXPECT_EQ(nearest_name("lo", {"log", "cubic"}), "log");
  EXPECT_EQ(nearest_name("two-stage", {"log", "two_stage"}), "two_stage");
}

}  // namespace
}  // namespace bb
