// The JSON reader: what the grammar allows and we do not, each with its line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/input/json.hpp"

namespace bb {
namespace {

using nlohmann::json;

std::string nested(int n) {
  return std::string(static_cast<std::size_t>(n), '[') + std::string(static_cast<std::size_t>(n), ']');
}

struct Refusal {
  JsonFault fault = JsonFault::syntax;
  std::string where, found;
};

Refusal refusal(const std::string& text) {
  try {
    parse_json(text, "a.json");
  } catch (const JsonError& error) {
    return {error.fault(), error.violations().front().where, error.violations().front().found};
  }
  ADD_FAILURE() << "accepted: " << text.substr(0, 60);
  return {};
}

TEST(Json, SoundTextIsReadAsTheLibraryReadsIt) {
  const std::string text = R"({"a": [1, -2, 0.1, 1e300, true, null, "x\u0041"], "b": {"a": {"a": []}}})";
  EXPECT_EQ(parse_json(text, "a.json"), json::parse(text));
  EXPECT_EQ(parse_json("9007199254740992", "a.json"), json(9007199254740992));
  EXPECT_EQ(parse_json("-9007199254740992", "a.json"), json(-9007199254740992));
}

TEST(Json, DepthIsCapped) {
  EXPECT_EQ(parse_json(nested(max_json_depth), "a.json").size(), 1u);
  for (const int n : {max_json_depth + 1, 1000, 1000000}) {
    EXPECT_EQ(refusal(nested(n)).fault, JsonFault::too_deep) << n;
  }
  EXPECT_EQ(refusal("{\n\"a\":\n" + nested(max_json_depth)).where, "a.json:3");
}

TEST(Json, ARepeatedKeyHasItsLine) {
  const Refusal top = refusal("{\n\"a\": 1,\n\"b\": 2,\n\"a\": 3}");
  EXPECT_EQ(top.fault, JsonFault::repeated_key);
  EXPECT_EQ(top.where, "a.json:4");
  EXPECT_NE(top.found.find("\"a\""), std::string::npos);
  EXPECT_EQ(refusal(R"({"x": [{"a": 1}, {"a": 1, "\u0061": 2}]})").fault, JsonFault::repeated_key);
  EXPECT_EQ(parse_json(R"({"a": {"a": 1}, "b": {"a": 1}})", "a.json").size(), 2u);
}

TEST(Json, NumbersThatWouldNotBeReadBackAreRefused) {
  for (const char* text :
       {"9007199254740993", "18446744073709551615", "-9007199254740993", "-9223372036854775808"}) {
    EXPECT_EQ(refusal(text).fault, JsonFault::large_integer) << text;
    EXPECT_EQ(refusal(text).found, text);
    EXPECT_TRUE(parse_json(text, "a.json", LargeIntegers::rounded).is_number());
  }
  EXPECT_EQ(refusal("{\"a\": [1, {\"b\": [2, 3]}, {\"c/d\": 0,\n \"e\": [[], {}, 9007199254740993]}]}").where,
            "a.json:2#/a/2/e/2");
  EXPECT_EQ(refusal("[[1, 2], -9007199254740993]").where, "a.json:1#/1");
  EXPECT_EQ(refusal("{\"c/d\": 9007199254740993}").where, "a.json:1#/c~1d");
  const Refusal overflow = refusal("{\"a\":\n1e999\n}");
  EXPECT_EQ(overflow.fault, JsonFault::number_range);
  EXPECT_EQ(overflow.where, "a.json:2");
  EXPECT_NE(overflow.found.find("1e999"), std::string::npos);
}

TEST(Json, BadSyntaxHasItsLine) {
  EXPECT_EQ(refusal("{\n\"a\": ,\n}").where, "a.json:2");
  EXPECT_EQ(refusal("").where, "a.json:1");
  EXPECT_EQ(refusal("{\n\n").fault, JsonFault::syntax);
  EXPECT_EQ(refusal("\"\xff\"").fault, JsonFault::syntax);
}

}  // namespace
}  // namespace bb
