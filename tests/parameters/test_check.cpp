// What a list of parameters reports of an object: one message form each, with place, value and what is allowed.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/parameters/check.hpp"
#include "core/base/parameters/units.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// "where: found ...; allowed: ..." of every violation of one row given one value.
std::string said(const Rule& rule, const char* value) {
  json object = {{"row", json::parse(value)}};
  std::vector<Violation> violations;
  check_object(object, {"", {{"row", rule, no_default, ""}}, false, {}, ""}, "a.json#", violations);
  EXPECT_EQ(object.contains("row"), violations.empty());  // what is wrong is removed
  return violations.empty() ? "" : ConfigError(violations).what();
}

ParameterList inner(const json&) {
  return {"", {{"n", required(count(1, 9)), no_default, ""}}, false, {}, ""};
}

Rule of(Kind kind) {
  Rule rule;
  rule.kind = kind;
  rule.list = inner;
  return rule;
}

TEST(Check, EachFormNamesPlaceValueAndWhatIsAllowed) {
  const Rule any = any_number(""), vector = any_vector("m");
  Rule ints = count(0, 9), box = vector, values = of(Kind::values);
  ints.kind = Kind::integers;
  box.kind = Kind::box;
  values.min_size = 1;
  const std::vector<std::tuple<Rule, const char*, std::string>> forms = {
      {flag(), "1", "found 1; allowed: true or false"},
      {count(1, 9), "0", "found 0; allowed: an integer >= 1 and <= 9"},
      {count(1, 9), "2.5", "found 2.5; allowed: an integer >= 1 and <= 9"},
      {any, "\"1\"", "found \"1\"; allowed: a number"},
      {positive("s"), "0", "found 0; allowed: a number >= 1e-18 and <= 1e+09 (s)"},
      {non_negative("1"), "-1", "found -1; allowed: 0, or a number >= 1e-36 and <= 1e+18"},
      {open_low(number_in(-1, 0.5, "1")), "-1", "found -1; allowed: a number > -1 and <= 0.5"},
      {open_high(open_low(number_in(0, 0.5, "1"))), "0.5", "found 0.5; allowed: a number >= 1e-36 and < 0.5"},
      {any_text(), "3", "found 3; allowed: a string"},
      {text_up_to(3), "\"\"", "found \"\"; allowed: a string of at least 1 and at most 3 bytes"},
      {text_up_to(3), "\"abcd\"", "found \"abcd\"; allowed: a string of at least 1 and at most 3 bytes"},
      {word({"jacobi", "none"}), "\"jacoby\"",
       "found \"jacoby\"; allowed: one of jacobi, none (did you mean jacobi?)"},
      {word({"jacobi", "none"}), "null", "found null; allowed: one of jacobi, none"},
      {word({"only"}), "\"other\"", "found \"other\"; allowed: \"only\""},
      {words({"a", "b"}), "[]",
       "found []; allowed: an array of at least 1 elements, each once and one of a, b"},
      {words({"a", "b"}), "[\"a\", \"a\"]",
       "found [\"a\",\"a\"]; allowed: an array of at least 1 elements, each once and one of a, b"},
      {ints, "3", "found 3; allowed: an array of integers >= 0 and <= 9"},
      {texts(), "[]", "found []; allowed: an array of one or more strings, none of them empty"},
      {texts(), "\"a\"", "found \"a\"; allowed: an array of one or more strings, none of them empty"},
      {vector, "[1, 2]", "found [1,2]; allowed: an array of 3 numbers (m)"},
      {direction(), "[0, 0, 0.0]", "found [0,0,0.0]; allowed: an array of 3 numbers, not all 0"},
      {box, "[[0, 0, 0]]", "found [[0,0,0]]; allowed: an array of 2 arrays of 3 numbers (m)"},
      {values, "[]", "found []; allowed: an array of at least 1 elements"},
      {of(Kind::object), "3", "found 3; allowed: an object"},
      {of(Kind::objects), "{}", "found {}; allowed: an array"},
  };
  for (const auto& [rule, value, expected] : forms) EXPECT_EQ(said(rule, value), "a.json#/row: " + expected);
}

TEST(Check, ElementsAreNamedByTheirIndex) {
  EXPECT_EQ(said(words({"a", "b"}), "[\"a\", \"c\"]"), "a.json#/row/1: found \"c\"; allowed: one of a, b");
  EXPECT_EQ(said(texts(), "[\"a\", \"\"]"), "a.json#/row/1: found \"\"; allowed: a string that is not empty");
  EXPECT_EQ(said(any_vector("m"), "[1, null, 2]"),
            "a.json#/row/1: found null; allowed: a number >= -1e+15 and <= 1e+15 (m)");
}

TEST(Check, SizesAreThoseOfTheUnit) {
  for (const char* unit :
       {"m", "s", "m/s", "m/s^2", "deg", "rad", "rad/s", "1", "N/m", "Pa", "kg/m^3", "J", "d_hat"}) {
    const auto [least, most] = sizes_of(unit);
    EXPECT_GT(least, 0) << unit;
    EXPECT_TRUE(std::isnormal(std::pow(least, 8)) && std::isnormal(std::pow(most, 8))) << unit;
    for (const double good : {least, 1.0, most}) {
      EXPECT_EQ(said(positive(unit), json(good).dump().c_str()), "") << unit;
      EXPECT_EQ(said(non_negative(unit), json(good).dump().c_str()), "") << unit;
      EXPECT_EQ(said(any_number(unit), json(-good).dump().c_str()), "") << unit;
    }
    for (const double bad : {5e-324, least / 2, most * 2, 1e308}) {
      EXPECT_NE(said(positive(unit), json(bad).dump().c_str()), "") << unit << " " << bad;
    }
    EXPECT_EQ(said(non_negative(unit), "0"), "") << unit;
    for (const char* bad : {"1e308", "1e-310", "5e-324"})
      EXPECT_NE(said(non_negative(unit), bad), "") << unit;
    EXPECT_NE(said(any_number(unit), "-1e308"), "") << unit;
    EXPECT_NE(said(any_vector(unit), "[0, 1e308, 0]"), "") << unit;
    EXPECT_EQ(said(any_vector(unit), "[0, 5e-324, 0]"), "") << unit;
  }
}

TEST(Check, TextsHaveNoControlCharacters) {
  const std::string allowed = "; allowed: a string, without control characters";
  EXPECT_EQ(said(any_text(), R"("a\u001b[31m")"), "a.json#/row: found \"a\\u001b[31m\"" + allowed);
  for (const char* bad : {R"("\u0000")", R"("a\nb")", R"("\u007f")", R"("\u009b1m")"})
    EXPECT_NE(said(any_text(), bad), "") << bad;
  EXPECT_EQ(said(any_text(), "\"\u00e9\u4e2d \u00a0\""), "");
  EXPECT_EQ(said(free_text(), R"("a\n\tb")"), "");
  EXPECT_EQ(said(free_text(), R"("a\r\nb")"), "");
  EXPECT_NE(said(free_text(), R"("a\n\u001b")").find("without control characters but line ends and tabs"),
            std::string::npos);
}

std::string said_of(const char* text, const ParameterList& list) {
  json object = json::parse(text);
  std::vector<Violation> violations;
  check_object(object, list, "a.json#", violations);
  return violations.empty() ? "" : ConfigError(violations).what();
}

TEST(Check, KeysThatAreUnknownMissingOrOfSeveralForms) {
  const ParameterList list = {
      "",
      {{"pointer", any_text(), no_default, ""}, {"cases", of(Kind::object), no_default, ""}},
      false,
      {{"pointer"}, {"cases"}},
      "{pointer} or {cases}"};
  EXPECT_EQ(
      said_of(R"({"pointer": "a", "case": 1})", list),
      "a.json#/case: found the unknown key \"case\"; allowed: one of pointer, cases (did you mean cases?)");
  EXPECT_EQ(said_of(R"({"cases": {}})", list),
            "a.json#/cases/n: found nothing; allowed: an integer >= 1 and <= 9");
  EXPECT_EQ(said_of("{}", list), "a.json#: found an object with nothing; allowed: {pointer} or {cases}");
  EXPECT_EQ(said_of(R"({"pointer": "a", "cases": {"n": 1}})", list),
            "a.json#: found an object with cases, pointer; allowed: {pointer} or {cases}");
  EXPECT_EQ(said_of(R"({"cases": {"n": 1}})", list), "");
}

TEST(Check, WordsOfBeforeAreReadAsThoseOfNow) {
  const ParameterList list = {
      "", {{"row", word({"new_name", "other"}, {{"old_name", "new_name"}}), "other", ""}}, false, {}, ""};
  std::vector<Violation> violations;
  json object = {{"row", "old_name"}};
  check_object(object, list, "a.json#", violations);
  EXPECT_TRUE(violations.empty());
  EXPECT_EQ(object, json({{"row", "new_name"}}));
  EXPECT_EQ(said(list.rows[0].rule, "\"old\""),
            "a.json#/row: found \"old\"; allowed: one of new_name, other");
  EXPECT_EQ(own_parameters(list.rows, {{"row", std::string("old_name")}}, "/here"),
            (ParameterMap{{"row", std::string("new_name")}}));
}

TEST(Check, LongTextsAreCut) {
  const std::string long_key(1000, 'x'), text = "{\"" + long_key + "\": 1}";
  EXPECT_LT(said_of(text.c_str(), inner(json())).size(), 400u);
}

TEST(OwnParameters, AreCheckedAndCompleted) {
  const std::vector<Parameter> rows = {
      {"a", positive("m"), 2, ""}, {"b", flag(), true, ""}, {"c", positive("1"), no_default, ""}};
  const ParameterMap made = own_parameters(rows, {{"a", 3}, {"of_another", "x"}}, "/here");
  EXPECT_EQ(made, (ParameterMap{{"a", 3.0}, {"b", true}}));
  EXPECT_EQ(number(made, "a"), 3.0);
  EXPECT_FALSE(optional_number(made, "c"));
  try {
    own_parameters(rows, {{"a", -1.0}}, "/here");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "/here/a: found -1.0; allowed: a number >= 1e-15 and <= 1e+15 (m)");
  }
}

}  // namespace
}  // namespace bb
