// The contract of `eval` round the kinds: ids, order, errors, exit codes, number format.
#include <cmath>

#include "tests/experiments/eval_asking.hpp"

namespace bb::test::eval_protocol_test {
namespace {

const char* const kCubic = R"("kind": "shape", "shape": "cubic", "d": 0.5, "d_hat": 1)";

TEST(EvalProtocol, AnswersInOrderAndEchoesIdsAsWritten) {
  const std::vector<std::string> ids = {"7",
                                        "-0.0",
                                        "\"a\\u00e9\\\"}\"",
                                        "123456789012345678901234567890",
                                        "1e400",
                                        "null",
                                        "true",
                                        "[1, {\"id\": 2}]",
                                        "{\"id\": [\"}\", 3]}"};
  std::string lines;
  for (const std::string& id : ids) lines += "{\"id\": " + id + ", " + kCubic + "}\n";

  const std::istringstream unused;
  std::istringstream in(lines);
  std::ostringstream out, err;
  run_eval(in, out, err);
  std::istringstream answers(out.str());

  std::size_t n = 0;
  for (std::string line; std::getline(answers, line); ++n) {
    EXPECT_TRUE(line.starts_with("{\"id\":" + ids[n] + ",")) << line;
  }
  EXPECT_EQ(n, ids.size());
}

TEST(EvalProtocol, IdComesLastOrIsAbsent) {
  EXPECT_EQ(ask_text(std::string("{") + kCubic + ", \"id\": 5}\n").answers[0]["id"], 5);
  EXPECT_FALSE(ask_text(std::string("{") + kCubic + "}\n").answers[0].contains("id"));
}

TEST(EvalProtocol, BadLinesAreAnsweredAndSpareTheOthers) {
  const std::string good = std::string("{\"id\": 1, ") + kCubic + "}";
  const std::vector<std::string> bad = {"{",
                                        "nonsense",
                                        "[1]",
                                        "5",
                                        "\"text\"",
                                        "{\"id\": 3, \"kind\": NaN}",
                                        "{} {}",
                                        "null",
                                        "{}",
                                        "\xff",
                                        "{\"id\": 4, \"kind\": \"shape\",}"};
  for (const std::string& line : bad) {
    const Reply reply = ask_text(good + "\n" + line + "\n" + good + "\n");
    ASSERT_EQ(reply.answers.size(), 3u) << line;
    EXPECT_EQ(reply.code, 2);
    EXPECT_TRUE(reply.answers[1].contains("error")) << line;
    EXPECT_TRUE(reply.answers[1]["id"].is_null()) << line;
    EXPECT_EQ(reply.answers[1].size(), 2u);
    EXPECT_EQ(reply.answers[0], reply.answers[2]);
    EXPECT_FALSE(reply.answers[0].contains("error"));
    EXPECT_EQ(reply.talk, "eval: 1 of 3 queries could not be answered\n");
  }
}

TEST(EvalProtocol, BlankLinesCarriageReturnsAndAMissingLastNewlineAreFine) {
  const std::string q = std::string("{") + kCubic + "}";
  const Reply reply = ask_text("\xEF\xBB\xBF" + q + "\r\n\r\n   \t\n" + q);
  EXPECT_EQ(reply.code, 0);
  EXPECT_EQ(reply.answers.size(), 2u);
  EXPECT_EQ(reply.talk, "");
  EXPECT_EQ(ask_text("").code, 0);
}

TEST(EvalProtocol, EveryFieldIsRequiredUnlessItMayBeLeftOut) {
  std::size_t checked = 0;
  for (const Example& example : examples()) {
    ask(example.query);
    for (const auto& [name, value] : example.query.items()) {
      json less = example.query;
      less.erase(name);
      const bool optional =
          std::find(example.optional.begin(), example.optional.end(), name) != example.optional.end();
      if (optional) {
        ask(less);
      } else {
        EXPECT_NE(refused(less).find("/" + name), std::string::npos) << less;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 60u);
}

TEST(EvalProtocol, WrongTypesAndUnknownFieldsAreRefusedByName) {
  const std::vector<json> wrong = {nullptr, "NaN", json::array(), json::object(),
                                   json::array({json::array()})};
  for (const Example& example : examples()) {
    json more = example.query;
    more["colour"] = 1;
    EXPECT_NE(refused(more).find("/colour"), std::string::npos);
    for (const auto& [name, value] : example.query.items()) {
      for (const json& v : wrong) {
        json bad = example.query;
        bad[name] = v;
        const std::string error = refused(bad);
        EXPECT_NE(error.find("/" + name), std::string::npos) << bad << "\n" << error;
        EXPECT_NE(error.find("allowed: "), std::string::npos) << error;
      }
    }
  }
}

TEST(EvalProtocol, AllViolationsOfALineAreNamedAtOnce) {
  const std::string error = refused(
      {{"kind", "shape"}, {"shape", "cubik"}, {"d", -1}, {"d_hat", 0}, {"dhat", 1}, {"argument", "Gap"}});
  for (const char* part : {"/shape", "cubic?", "/d;", "-1", "/d_hat", "/dhat", "/argument", "squared_gap"}) {
    EXPECT_NE(error.find(part), std::string::npos) << part << " in " << error;
  }
  EXPECT_NE(refused({{"kind", "shap"}}).find("did you mean shape?"), std::string::npos);
  EXPECT_NE(refused({{"kind", "svd"}, {"precision", "half"}}).find("/precision"), std::string::npos);
}

TEST(EvalProtocol, TheSameFieldTwiceIsAnError) {
  const Reply reply = ask_text(std::string("{") + kCubic + ", \"d\": 0.25, \"id\": 9}\n");
  EXPECT_EQ(reply.code, 2);
  EXPECT_EQ(reply.answers[0]["id"], 9);
  EXPECT_NE(reply.answers[0]["error"].get<std::string>().find("/d"), std::string::npos);
  const Reply escaped = ask_text(std::string("{") + kCubic + R"(, "\u0064": 0.25, "\u0069d": 9})" + "\n");
  EXPECT_EQ(escaped.code, 2);
  EXPECT_EQ(escaped.answers[0]["id"], 9);
}

TEST(EvalProtocol, MinusZeroIsZero) {
  for (const char* shape : {"log", "log_squared", "two_stage", "minimax"}) {
    json query = {{"kind", "shape"}, {"shape", shape}, {"d", -0.0}, {"d_hat", 1}};
    EXPECT_EQ(ask(query)["status"], "infinite") << shape;
  }
}

TEST(EvalProtocol, NumbersOutOfRangeKeepTheirId) {
  const Reply reply =
      ask_text("{\"id\": \"x\", \"kind\": \"shape\", \"shape\": \"log\", \"d\": 1e400, \"d_hat\": 1}\n");
  EXPECT_EQ(reply.code, 2);
  EXPECT_EQ(reply.answers[0]["id"], "x");
  EXPECT_NE(refused({{"kind", "shape"}, {"shape", "log"}, {"d", 1e300}, {"d_hat", 1}, {"precision", "float"}})
                .find("after rounding to float"),
            std::string::npos);
}

TEST(EvalProtocol, NumbersReadBackToTheSameBits) {
  const double d = 0.1 / 3;
  const json answer =
      ask({{"kind", "distance"}, {"pair", "point_point"}, {"points", {{d, 0, 0}, {0, 0, 0}}}});
  EXPECT_EQ(answer["d"].get<double>(), d);
  EXPECT_TRUE(answer["weights"][0].is_number_float());  // 1.0, not 1
}

TEST(EvalProtocol, FloatRunsInFloat) {
  json query = {{"kind", "shape"}, {"shape", "log"}, {"d", 0.1}, {"d_hat", 0.3}};
  const double exact = ask(query)["d2b"];
  query["precision"] = "float";
  const double single = ask(query)["d2b"];
  EXPECT_NE(single, exact);
  EXPECT_EQ(single, static_cast<double>(static_cast<float>(single)));
  EXPECT_NEAR(single, exact, 1e-6 * exact);
}

TEST(EvalProtocol, EveryKindAnswersInFloat) {
  for (const Example& example : examples()) {
    json query = example.query;
    query["precision"] = "float";
    ask(query);
  }
}

TEST(EvalProtocol, AnOutputThatCannotBeWrittenEndsTheRun) {
  std::istringstream in(std::string("{") + kCubic + "}\n");
  std::ostringstream out, err;
  out.setstate(std::ios::badbit);
  EXPECT_EQ(run_eval(in, out, err), 75);
  EXPECT_NE(err.str(), "");
}

TEST(EvalProtocol, TheSchemaIsPrintedAndNamesEveryKind) {
  std::ostringstream out;
  print_eval_schema(out);
  const json schema = json::parse(out.str());
  for (const Example& example : examples()) {
    const std::string kind = example.query["kind"];
    EXPECT_TRUE(schema["$defs"].contains("query_" + kind)) << kind;
    EXPECT_TRUE(schema["$defs"].contains("answer_" + kind)) << kind;
  }
}

}  // namespace
}  // namespace bb::test::eval_protocol_test
