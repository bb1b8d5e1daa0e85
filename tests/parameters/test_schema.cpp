// JSON Schema of a list: every keyword from the row that it stands for.
#include <gtest/gtest.h>

#include "core/base/parameters/check.hpp"

namespace bb {
namespace {

using json = nlohmann::json;

json schema(const Rule& rule, ParameterValue fallback = no_default) {
  const ParameterList list{"", {{"row", rule, std::move(fallback), "what"}}, false, {}, ""};
  return json(schema_of(list))["properties"]["row"];
}

TEST(Schema, KeywordsOfARow) {
  EXPECT_EQ(
      schema(open_high(open_low(number_in(0, 0.5, "m"))), 0.25),
      json::parse(R"({"description": "what", "type": "number", "minimum": 1e-15, "exclusiveMaximum": 0.5,
                            "default": 0.25, "unit": "m"})"));
  EXPECT_EQ(schema(count(1, 9), 3), json::parse(R"({"description": "what", "type": "integer", "minimum": 1,
                                                   "maximum": 9, "default": 3, "unit": "1"})"));
  EXPECT_EQ(
      schema(words({"a", "b"}), std::vector<std::string>{"a"}),
      json::parse(R"({"description": "what", "type": "array", "minItems": 1, "items": {"enum": ["a", "b"]},
                            "uniqueItems": true, "default": ["a"]})"));
  EXPECT_EQ(schema(name_in([] { return std::vector<std::string>{"a"}; })),
            json::parse(R"({"description": "what", "type": "string"})"));  // plugins add names
  EXPECT_EQ(schema(any_vector("m")),
            json::parse(R"({"description": "what", "type": "array", "minItems": 3, "maxItems": 3,
                            "items": {"type": "number", "minimum": -1e15, "maximum": 1e15}, "unit": "m"})"));
  EXPECT_EQ(schema(computed(positive("s"), "the scene's"), 1)["description"], "what Default: the scene's.");
  EXPECT_EQ(
      schema(positive("s")),
      json::parse(
          R"({"description": "what", "type": "number", "minimum": 1e-18, "maximum": 1e9, "unit": "s"})"));
  EXPECT_EQ(schema(any_text())["not"]["pattern"], R"([\u0000-\u001F\u007F-\u009F])");
  EXPECT_EQ(schema(non_negative("m"))["not"],
            json::parse(R"({"exclusiveMinimum": 0, "exclusiveMaximum": 1e-15})"));
  EXPECT_FALSE(schema(computed(positive("s"), "the scene's"), 1).contains("default"));
}

TEST(Schema, ObjectsAreClosedAndNameWhatTheyRequire) {
  const ParameterList list{"doc",
                           {{"a", required(flag()), no_default, ""}, {"b", flag(), no_default, ""}},
                           false,
                           {{"a"}, {"b"}},
                           "a or b"};
  const json out = json(schema_of(list));
  EXPECT_EQ(out["required"], json::array({"a"}));
  EXPECT_EQ(out["additionalProperties"], false);
  EXPECT_EQ(out["oneOf"][1], json::parse(R"({"required": ["b"], "not": {"anyOf": [{"required": ["a"]}]}})"));
}

}  // namespace
}  // namespace bb
